"""Frames of Arnold: motion from P and the header's cameras, or from motionvector."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from svgf_cl import FileError, open_sequence
from svgf_cl.io.exr import read_image
from svgf_cl.io.readers import reader_of
from tests.renderers import ARNOLD_HEADER, Header, arnold, matrices, moments, same_frames, truth, written

TOLERANCE = {"motion": 1e-3}  # pixels; headers and positions are single precision


def headers() -> dict[int, Header]:
    return {at.number: ARNOLD_HEADER | matrices(at, "Arnold") for at in moments()}


def test_motion_is_that_of_positions_between_the_cameras_of_headers(tmp_path: Path) -> None:
    frames = open_sequence(written(tmp_path, {at.number: arnold(at) for at in moments()}, headers()))
    assert frames.reading.reader.name == "arnold"
    expected = [truth(at, motion=3) for at in moments()]
    expected[0].motion[:] = 0  # nothing tells the camera before
    same_frames(frames, expected, TOLERANCE)
    np.testing.assert_allclose(frames.motion_to_next(frames.read(0))[..., :2], moments()[0].to_next, atol=1e-3)
    assert len(frames.reading.lights) == 4


def test_depth_does_without_positions(tmp_path: Path) -> None:
    planes = {at.number: arnold(at, position=False) for at in moments()}
    frames = open_sequence(written(tmp_path, planes, headers()))
    np.testing.assert_allclose(frames[1].motion, moments()[1].frame.motion, atol=1e-3)


def test_motion_vectors_are_read(tmp_path: Path) -> None:
    planes = {at.number: arnold(at, position=False, motion=True) for at in moments()}
    frames = open_sequence(written(tmp_path, planes, ARNOLD_HEADER))
    same_frames(frames, [truth(at) for at in moments()])
    flipped = open_sequence(tmp_path, motion_scale=(2.0, -2.0))[0]
    np.testing.assert_array_equal(flipped.motion, moments()[0].frame.motion[..., :2] * (2, -2))


@pytest.mark.parametrize("nothing", [0.0, 1e30, np.inf])
def test_depth_is_infinite_where_nothing_was_hit(nothing: float, tmp_path: Path) -> None:
    at = moments()[0]
    planes = arnold(at, motion=True)
    planes["Z"] = np.where(at.hit, at.frame.depth, np.float32(nothing))
    (frame,) = open_sequence(written(tmp_path, {1: planes}, ARNOLD_HEADER))
    np.testing.assert_array_equal(frame.depth, at.frame.depth)


@pytest.mark.parametrize(
    ("lost", "words"),
    [
        ("N", "expected normal in a file of Arnold, .*; add the AOV N"),
        ("Z", "expected depth in a file of Arnold, .*; add the AOV Z"),
        ("motionvector", "expected motion in a file of Arnold, .*; add the AOV P, or motionvector .*cameras.json"),
        ("RGBA", "expected color in a file of Arnold"),
    ],
)
def test_a_missing_pass_is_named_with_the_aov_that_has_it(lost: str, words: str, tmp_path: Path) -> None:
    names = list(lost) if lost == "RGBA" else [lost]
    planes = {
        at.number: {c: p for c, p in arnold(at, position=False, motion=True).items() if c.split(".")[0] not in names}
        for at in moments()
    }
    with pytest.raises(FileError, match=rf"shot_0001\.exr: {words}"):
        open_sequence(written(tmp_path, planes, ARNOLD_HEADER))[0]


def test_a_layer_of_another_case_is_another_layer(tmp_path: Path) -> None:
    at = moments()[0]
    planes = {**arnold(at, motion=True), **{f"n.{c}": np.zeros(at.frame.shape, np.float32) for c in "XYZ"}}
    same_frames(open_sequence(written(tmp_path, {1: planes}, ARNOLD_HEADER)), [truth(at)])


SAMPLE = Path(__file__).parents[5] / "shared" / "samples" / "openexr" / "cryptomatte" / "multichannel.exr"


@pytest.mark.skipif(not SAMPLE.exists(), reason=f"{SAMPLE} is not here")
def test_a_file_of_arnold_is_known() -> None:
    assert reader_of(read_image(SAMPLE)).name == "arnold"
