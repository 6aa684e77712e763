"""``svgf-cl compare`` as people use it."""

from __future__ import annotations

import shutil
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from svgf_cl.io.frames import read_frame, write_frame
from svgf_cl.io.pictures import read_picture, write_picture
from tests.command_line import NAMES, run


def test_compare_finds_a_picture_equal_to_itself(rendered: Path) -> None:
    picture = rendered / NAMES[0]
    assert run("compare", picture, picture, "--min-psnr", "200", "--min-ssim", "1", "--max-relmse", "0") == 0


def test_nan_misses_every_threshold(frames: Path) -> None:
    picture = read_picture(frames / NAMES[0])
    picture[0, 0] = np.nan
    write_picture(frames / "nan.exr", picture)
    assert run("compare", frames / "nan.exr", frames / NAMES[0], "--min-psnr", "1") == 1
    assert run("compare", frames / "nan.exr", frames / NAMES[0], "--max-relmse", "1000") == 1


@pytest.mark.parametrize("stops", ["2000", "-65", "nan", "inf"])
def test_a_bad_exposure(stops: str, rendered: Path, refused) -> None:
    refused("expected stops in -64..64", "compare", rendered, rendered, f"--exposure={stops}")


@pytest.mark.parametrize("option", ["--min-psnr", "--min-ssim", "--max-relmse"])
def test_a_threshold_that_is_no_number(option: str, rendered: Path, refused) -> None:
    refused(f"'{option}': expected a number, got nan", "compare", rendered, rendered, option, "nan")


def test_empty_input(tmp_path: Path, refused) -> None:
    refused("expected files named", "compare", tmp_path, tmp_path)


def test_sizes_that_differ(frames: Path, refused) -> None:
    frame = read_frame(frames / NAMES[1])
    cropped = {name: np.ascontiguousarray(value[:-2]) for name, value in frame.present().items()}
    write_frame(frames / NAMES[1], replace(frame, **cropped))
    refused("0001.exr: expected 32x18 pixels", "compare", frames / NAMES[1], frames / NAMES[0])


def test_compare_wants_like_with_like(frames: Path, refused) -> None:
    refused("two files or two folders", "compare", frames, frames / NAMES[0])
    (frames / "few").mkdir()
    shutil.copy(frames / NAMES[0], frames / "few")
    refused("expected a picture number 1", "compare", frames / "few", frames)


def test_measuring_without_scikit_image_says_how_to_get_it(rendered: Path, refused, monkeypatch) -> None:
    for module in ("skimage", "skimage.metrics"):
        monkeypatch.setitem(sys.modules, module, None)
    refused("pip install '.[metrics]'", "compare", rendered, rendered)
