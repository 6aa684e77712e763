"""Frames, pictures and references are found, paired by number and read as they are meant."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from svgf_cl import Frame
from svgf_cl.compare.recorded import Recorded, open_frames, open_pictures
from svgf_cl.errors import FileError
from svgf_cl.io.exr import read_image, write_image
from svgf_cl.io.frames import frame_path, write_frame
from svgf_cl.io.pictures import write_picture
from svgf_cl.io.reading import ReadAs
from svgf_cl.io.synthetic import room_frames
from svgf_cl.io.window import Window
from tests.renderers import cameras_file

SHAPE = (12, 16)
FRAMES = list(room_frames(SHAPE, 3, signals=2))


def silent() -> None:
    """No progress."""


def grey(number: int, rows: int = SHAPE[0]) -> np.ndarray:
    return np.full((rows, SHAPE[1], 3), 0.125 * (number + 1), np.float32)


def pictures(folder: Path, *names: str, rows: int = SHAPE[0]) -> Path:
    """The folder with pictures of these names, each grey by its place among them."""
    folder.mkdir()
    for number, name in enumerate(names):
        write_picture(folder / name, grey(number, rows))
    return folder


@pytest.fixture
def shot(tmp_path: Path) -> Path:
    """Three frames numbered from 7, and references of the first and the last."""
    for number, frame in enumerate(FRAMES, 7):
        write_frame(frame_path(tmp_path / "shot", number), frame)
    for number in (7, 9):
        write_picture(frame_path(tmp_path / "shot", number, "reference"), grey(number - 7))
    return tmp_path / "shot"


def test_frames_are_what_is_denoised_and_some_have_a_reference(shot: Path) -> None:
    found = open_frames([shot], shot, ReadAs(), jitter=True)
    assert (found.name, found.shape, found.steps) == ("shot", SHAPE, 2)
    assert (list(found.numbers), list(found.judged)) == ([7, 8, 9], [7, 9])
    for have, want in zip(found.frames(), FRAMES, strict=True):
        assert have.present().keys() == want.present().keys()
        np.testing.assert_array_equal(have.direct, want.direct)
    ticks: list[None] = []
    truths = found.truths(lambda: ticks.append(None))
    assert len(ticks) == 2
    for number, halves in truths.items():
        np.testing.assert_array_equal(halves, [grey(number - 7)] * 2)


def test_it_is_said_whether_filters_antialias(shot: Path) -> None:
    notes = [open_frames([shot], shot, ReadAs(), jitter=jitter).note.split(";")[0] for jitter in (True, False)]
    assert notes == ["antialiased over time", "not antialiased"]


@pytest.mark.parametrize("emission", [None, np.full((*SHAPE, 3), 0.25, np.float32)])
def test_a_frame_without_a_colour_gets_that_of_its_signals(emission: np.ndarray | None, tmp_path: Path) -> None:
    write_frame(tmp_path / "frame.exr", replace(FRAMES[0], color=None, emission=emission))
    write_picture(tmp_path / "truth.exr", grey(0))
    (frame,) = open_frames([tmp_path / "frame.exr"], tmp_path / "truth.exr", ReadAs(), jitter=False).frames()
    expected = FRAMES[0].direct + FRAMES[0].indirect + (0.0 if emission is None else emission)
    np.testing.assert_allclose(frame.color, expected, rtol=1e-6)


def test_frames_are_cut_to_the_window_that_references_show(tmp_path: Path) -> None:
    """Of one size with it, but a pixel further to the right and down."""
    write_frame(tmp_path / "frame.exr", FRAMES[0])
    image = read_image(tmp_path / "frame.exr")
    height, width = SHAPE
    windows = replace(image.windows, data=Window(1, 1, width, height), display=Window(0, 0, width, height))
    write_image(tmp_path / "frame.exr", replace(image, windows=windows))
    write_picture(tmp_path / "truth.exr", grey(0))
    (frame,) = open_frames([tmp_path / "frame.exr"], tmp_path / "truth.exr", ReadAs(), jitter=False).frames()
    np.testing.assert_array_equal(frame.depth[1:, 1:], FRAMES[0].depth[:-1, :-1])
    assert np.isinf(frame.depth[0]).all()
    assert not frame.direct[:, 0].any()


def test_one_frame_has_the_reference_whatever_the_numbers(shot: Path) -> None:
    found = open_frames([shot / "frame.0008.exr"], shot / "reference.0009.exr", ReadAs(), jitter=False)
    assert (found.name, list(found.judged)) == ("frame.0008", [8])
    assert found.references == {8: shot / "reference.0009.exr"}


def test_one_reference_of_several_frames_goes_by_its_number(shot: Path) -> None:
    assert open_frames([shot], shot / "reference.0009.exr", ReadAs(), jitter=False).judged == [9]
    nameless = Path(shutil.copy(shot / "reference.0009.exr", shot / "truth.exr"))
    with pytest.raises(FileError, match=r"truth\.exr: expected the number of one of the 3 frames in its name"):
        open_frames([shot], nameless, ReadAs(), jitter=False)


def test_a_reference_without_its_frame_is_refused(shot: Path) -> None:
    write_picture(shot / "reference.0010.exr", grey(0))
    for reference in (shot, shot / "reference.0010.exr"):
        with pytest.raises(FileError, match=r"reference\.0010\.exr: expected a frame number 10 among the frames"):
            open_frames([shot], reference, ReadAs(), jitter=False)


def test_frames_are_read_as_they_should_be(shot: Path) -> None:
    plain, flipped = (
        next(open_frames([shot], shot, ReadAs(motion_scale=scale), jitter=False).frames())
        for scale in ((1.0, 1.0), (-1.0, 2.0))
    )
    assert np.any(plain.motion)
    np.testing.assert_array_equal(flipped.motion, plain.motion * (-1, 2, 1))


def test_a_shot_that_lacks_a_frame_is_refused(shot: Path) -> None:
    (shot / "frame.0008.exr").unlink()
    with pytest.raises(FileError, match=r"frame\.0009\.exr: expected the previous frame"):
        open_frames([shot], shot, ReadAs(), jitter=False)


def test_the_inputs_have_a_name_that_changes_with_them(shot: Path) -> None:
    def identity(jitter: bool = True, **how: Any) -> str:
        return open_frames([shot], shot, ReadAs(**how), jitter=jitter).identity

    before = identity()
    assert identity() == before
    assert identity(jitter=False) != before
    assert identity(passes={"depth": "Z"}) != before
    cameras = cameras_file(shot, (8, 9))
    with_cameras = identity(cameras=cameras)
    assert with_cameras != before
    os.utime(cameras, (1, 1))
    assert identity(cameras=cameras) != with_cameras
    os.utime(shot / "reference.0009.exr", (1, 1))
    assert identity() != before


def test_pictures_and_references_are_paired_by_number(tmp_path: Path) -> None:
    a = pictures(tmp_path / "a", *(f"frame.{number:04d}.exr" for number in range(3)))
    b = pictures(tmp_path / "b", "frame.0000.exr", "reference.0001.exr", "reference.0002.exr")
    found = open_pictures(a, b)
    assert found.paths == {number: frame_path(a, number) for number in (1, 2)}
    assert found.references == {number: frame_path(b, number, "reference") for number in (1, 2)}
    assert found.name == "a"


def test_two_pictures_are_a_pair_whatever_their_names(tmp_path: Path) -> None:
    a = pictures(tmp_path / "a", "frame.0003.exr", "other.exr")
    found = open_pictures(a / "frame.0003.exr", a / "other.exr")
    assert (found.paths, found.references) == ({3: a / "frame.0003.exr"}, {3: a / "other.exr"})
    (frame,) = found.frames()
    np.testing.assert_array_equal(frame.color, grey(0))
    assert np.isinf(frame.depth).all()
    np.testing.assert_array_equal(found.truths(silent)[3][0], grey(1))


def test_a_reference_without_its_picture_is_refused(tmp_path: Path) -> None:
    a = pictures(tmp_path / "a", "frame.0000.exr")
    b = pictures(tmp_path / "b", "frame.0000.exr", "frame.0007.exr")
    with pytest.raises(FileError, match=r"expected a picture number 7 to compare with .*frame\.0007\.exr"):
        open_pictures(a, b)


def test_like_goes_with_like(tmp_path: Path) -> None:
    a = pictures(tmp_path / "a", "frame.0000.exr")
    for one, other in ((a, a / "frame.0000.exr"), (a / "frame.0000.exr", a)):
        with pytest.raises(FileError, match="expected two files or two folders"):
            open_pictures(one, other)
    with pytest.raises(FileError, match=r"nowhere\.exr: expected a file or a folder"):
        open_pictures(a, a / "nowhere.exr")


def read_pictures(found: Recorded) -> list[Frame]:
    return list(found.frames())


def read_references(found: Recorded) -> object:
    return found.truths(silent)


@pytest.mark.parametrize(("read", "odd"), [(read_pictures, "a"), (read_references, "b")])
def test_sizes_that_differ_are_refused(read: Callable[[Recorded], object], odd: str, tmp_path: Path) -> None:
    folders = [pictures(tmp_path / name, "frame.0000.exr", "frame.0001.exr") for name in ("a", "b")]
    write_picture(tmp_path / odd / "frame.0001.exr", grey(1, rows=13))
    with pytest.raises(FileError, match=rf"{odd}.frame\.0001\.exr: expected 16x12 pixels .* got 16x13"):
        read(open_pictures(*folders))


def test_frames_of_another_size_than_their_references_are_refused(shot: Path) -> None:
    for number in (7, 9):
        write_picture(frame_path(shot, number, "reference"), grey(0, rows=14))
    with pytest.raises(FileError, match=r"frame\.0007\.exr: expected 16x14 pixels as in the references, got 16x12"):
        next(open_frames([shot], shot, ReadAs(), jitter=False).frames())


def test_pictures_too_small_for_ssim_are_refused(tmp_path: Path) -> None:
    a = pictures(tmp_path / "a", "frame.0000.exr", rows=10)
    with pytest.raises(FileError, match=r"frame\.0000\.exr: expected at least 11x11 pixels, .* got 16x10"):
        open_pictures(a, a).truths(silent)
