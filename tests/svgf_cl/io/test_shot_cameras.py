"""Where the camera of a frame is from, and what its pixels count from."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from svgf_cl import Camera, FileError
from svgf_cl.io.sequence import find_frames
from svgf_cl.io.shot_cameras import ShotCameras
from svgf_cl.io.window import Window
from tests.renderers import ARNOLD_HEADER, NUMBERS, SHAPE, arnold, cameras_file, matrices, moments, written

DISPLAY = Window(0, 0, SHAPE[1], SHAPE[0])


@pytest.fixture
def paths(tmp_path: Path) -> list[Path]:
    """Frames of which the headers hold cameras."""
    headers = {at.number: ARNOLD_HEADER | matrices(at, "Arnold") for at in moments()}
    return find_frames([written(tmp_path / "shot", {at.number: arnold(at) for at in moments()}, headers)])


def assert_same(found: Camera | None, expected: Camera) -> None:
    assert found is not None
    np.testing.assert_allclose(found.world_to_view, expected.world_to_view, atol=1e-5)
    np.testing.assert_allclose((*found.focal, *found.center), (*expected.focal, *expected.center), rtol=1e-4)


def test_cameras_are_those_of_the_headers(paths: list[Path]) -> None:
    cameras = ShotCameras(paths, {}, DISPLAY)
    for at in moments():
        assert_same(cameras.at(at.number, DISPLAY), at.camera)
    assert cameras.at(NUMBERS[-1] + 1, DISPLAY) is None


def test_or_those_that_are_given_also_of_frames_that_are_not_there(paths: list[Path], tmp_path: Path) -> None:
    other = moments((9,))[0].camera
    cameras = ShotCameras(paths, {2: other}, DISPLAY)
    assert_same(cameras.at(1, DISPLAY), moments()[0].camera)
    assert_same(cameras.at(2, DISPLAY), other)
    before = ShotCameras(paths, cameras_file(tmp_path, (0, 1)), DISPLAY)
    assert_same(before.at(0, DISPLAY), moments((0,))[0].camera)


def test_pixels_count_from_the_data_window(paths: list[Path]) -> None:
    camera = moments()[0].camera
    found = ShotCameras(paths, {1: camera}, Window(10, 20, SHAPE[1], SHAPE[0])).at(1, Window(13, 25, 4, 4))
    assert_same(found, camera.cropped(3, 5))


def test_cameras_of_another_size_are_refused(paths: list[Path], tmp_path: Path) -> None:
    cameras = ShotCameras(paths, cameras_file(tmp_path, NUMBERS, (9, 9)), DISPLAY)
    with pytest.raises(FileError, match="expected the width 32 and height 20"):
        cameras.at(1, DISPLAY)
