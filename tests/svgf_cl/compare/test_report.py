"""Pictures find their references, and what is too far from one is said."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from svgf_cl.compare.metrics import Metrics
from svgf_cl.compare.report import COLUMNS, measured, misses, pairs, table_rows
from svgf_cl.errors import FileError
from svgf_cl.io.frames import frame_path
from svgf_cl.io.pictures import write_picture

GOOD, BAD = Metrics(40.0, 0.99, 0.001), Metrics(20.0, 0.5, 0.1)


def written(folder: Path, *names: str, rows: int = 12) -> Path:
    """The folder with pictures of these names."""
    folder.mkdir()
    for name in names:
        write_picture(folder / name, np.full((rows, 16, 3), 0.5, np.float32))
    return folder


def test_pictures_and_references_are_paired_by_number(tmp_path: Path) -> None:
    a = written(tmp_path / "a", *(f"frame.{number:04d}.exr" for number in range(3)))
    b = written(tmp_path / "b", "frame.0000.exr", "reference.0001.exr", "reference.0002.exr")
    assert pairs(a, b) == {
        str(number): (frame_path(a, number), frame_path(b, number, "reference")) for number in (1, 2)
    }
    assert pairs(a / "frame.0000.exr", b / "frame.0000.exr") == {
        "frame.0000.exr": (a / "frame.0000.exr", b / "frame.0000.exr")
    }


def test_a_reference_without_its_picture_is_refused(tmp_path: Path) -> None:
    a, b = written(tmp_path / "a", "frame.0000.exr"), written(tmp_path / "b", "frame.0000.exr", "frame.0007.exr")
    with pytest.raises(FileError, match="expected a picture number 7"):
        pairs(a, b)


def test_pictures_of_other_sizes_are_refused(tmp_path: Path) -> None:
    a, b = written(tmp_path / "a", "frame.0000.exr"), written(tmp_path / "b", "frame.0000.exr", rows=13)
    with pytest.raises(FileError, match=r"expected 16x13 pixels as in .*, got 16x12"):
        measured(a / "frame.0000.exr", b / "frame.0000.exr", 0.0)


def test_the_last_row_is_the_mean() -> None:
    rows = table_rows({"0": GOOD, "1": BAD})
    assert [row[0] for row in rows] == ["0", "1", "mean"]
    assert rows[0] == ("0", "40.00", "0.9900", "0.00100")
    assert {len(row) for row in rows} == {len(COLUMNS)}


def test_what_is_beyond_a_threshold_is_said_and_nan_is_beyond_all() -> None:
    assert misses(GOOD, 30, 0.9, 0.01) == misses(BAD, None, None, None) == []
    assert misses(BAD, 30, 0.9, 0.01) == [
        "PSNR 20.00 dB is below 30 dB",
        "SSIM 0.5000 is below 0.9",
        "relMSE 0.10000 is above 0.01",
    ]
    assert len(misses(Metrics(math.nan, math.nan, math.nan), 1, 0, 1e9)) == 3
