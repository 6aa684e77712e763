"""``svgf-cl check`` as people use it: a table, a picture, an exit code."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from svgf_cl.cli import main
from svgf_cl.frame import Frame
from svgf_cl.io.frames import frame_path, write_frame
from svgf_cl.io.synthetic import room_frames

SHAPE = (180, 320)


def run(*argv: str | Path) -> int:
    """Exit code of ``svgf-cl check argv``."""
    with pytest.raises(SystemExit) as left:
        main(["check", *map(str, argv)])
    return int(left.value.code or 0)


def written(folder: Path, frames: list[Frame]) -> Path:
    for number, frame in enumerate(frames):
        write_frame(frame_path(folder, number), frame)
    return folder


@pytest.fixture(scope="module")
def room() -> list[Frame]:
    return list(room_frames(SHAPE, 3))


def test_good_frames_pass(tmp_path: Path, room: list[Frame], capsys: pytest.CaptureFixture[str]) -> None:
    assert run(written(tmp_path, room)) == 0
    said = capsys.readouterr().out
    assert "3 frames: 0 findings" in said
    assert "normal: in world space: not checked: the camera does not turn" in said


def test_a_mistake_is_in_the_table_and_in_the_exit_code(
    tmp_path: Path, room: list[Frame], capsys: pytest.CaptureFixture[str]
) -> None:
    wrong = [replace(frame, motion=frame.motion * np.float32([-1, -1, 1])) for frame in room]
    assert run(written(tmp_path, wrong)) == 1
    said = " ".join(capsys.readouterr().out.split())
    for words in ("3 frames: 1 finding,", "motion", "error", "points the other", "negate it"):
        assert words in said


def test_a_picture_of_every_field(tmp_path: Path, room: list[Frame]) -> None:
    frames, sheet = written(tmp_path, room), tmp_path / "new" / "fields.png"
    assert run(frames, "-o", sheet) == 0
    with Image.open(sheet) as picture:
        assert picture.width > 2 * SHAPE[1]
        assert picture.height > 2 * SHAPE[0]


def test_a_picture_of_another_format_is_refused_before_anything_is_read(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(tmp_path / "missing", "-o", tmp_path / "fields.jpg") == 2
    assert "*.png" in capsys.readouterr().err


def test_a_file_without_a_field_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(tmp_path) == 2
    assert "frame.0000.exr" in capsys.readouterr().err


def test_a_gap_is_a_cut(tmp_path: Path, room: list[Frame], capsys: pytest.CaptureFixture[str]) -> None:
    folder = written(tmp_path, room)
    frame_path(folder, 1).unlink()
    assert run(folder) == 2
    assert "--allow-gaps" in capsys.readouterr().err
    assert run(folder, "--allow-gaps") == 0
    assert "motion: direction, axes, unit: not checked: it needs 2 consecutive frames" in capsys.readouterr().out
