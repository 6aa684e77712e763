"""Frames of Mitsuba: motion and depth from positions, or from distances, and the cameras beside the frames."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from svgf_cl import FileError, Frame, open_sequence
from svgf_cl.io.window import Window
from tests.exr_files import exr_bytes
from tests.renderers import (
    MITSUBA_HEADER,
    NUMBERS,
    SHAPE,
    Moment,
    Planes,
    cameras_file,
    mitsuba,
    moments,
    same_frames,
    truth,
    written,
)

# Positions are single precision at some ten units from the origin; a pixel is 1 / 18 of a unit at depth 1.
TOLERANCE = {"depth": 5e-6, "motion": 1e-4}
BEFORE = (0, *NUMBERS)  # a camera for the frame before the first


def shot(folder: Path, *without: str) -> Path:
    planes = {at.number: lacking(mitsuba(at), *without) for at in moments()}
    return written(folder, planes, MITSUBA_HEADER, "cbox.")


def lacking(planes: Planes, *names: str) -> Planes:
    return {channel: plane for channel, plane in planes.items() if channel.split(".")[0] not in names}


@pytest.mark.parametrize("without", [(), ("dd",), ("img",)])
def test_frames_are_read_with_the_cameras_beside_them(without: tuple[str, ...], tmp_path: Path) -> None:
    cameras_file(tmp_path, BEFORE)
    frames = open_sequence(shot(tmp_path / "noisy", *without))
    assert frames.reading.reader.name == "mitsuba"
    assert frames.reading.picture == ("R", "G", "B")
    same_frames(frames, [in_mitsuba(at) for at in moments()], TOLERANCE)
    for index, at in enumerate(moments()[:-1]):
        np.testing.assert_allclose(frames.motion_to_next(frames.read(index))[..., :2], at.to_next, atol=1e-4)
    assert frames.motion_to_next(frames.read(2)) is None, "nothing tells the camera of a frame behind the last"


def in_mitsuba(at: Moment) -> Frame:
    """The frame without ids, lamps and sky; nothing has no albedo."""
    frame = truth(at, "id", "emission", motion=3)
    frame.albedo[~at.hit] = 0
    return frame


def test_distances_along_rays_do_without_positions(tmp_path: Path) -> None:
    cameras_file(tmp_path, BEFORE)
    frames = open_sequence(shot(tmp_path, "pp"))
    same_frames(frames, [in_mitsuba(at) for at in moments()], TOLERANCE)


def test_without_a_camera_of_the_frame_before_the_first_one_stands_still(tmp_path: Path) -> None:
    cameras_file(tmp_path, NUMBERS)
    frames = open_sequence(shot(tmp_path))
    np.testing.assert_allclose(frames[0].motion, 0.0, atol=1e-12)
    np.testing.assert_allclose(frames[1].motion, moments()[1].frame.motion, atol=1e-4)


def test_a_crop_of_the_image_is_seen_by_the_same_camera(tmp_path: Path) -> None:
    """A film with a crop window: the data window is a part of the image, here another one in every frame."""
    cameras_file(tmp_path, BEFORE)
    for at, (x, y) in zip(moments(), ((0, 0), (7, 3), (12, 0)), strict=True):
        planes = {name: np.ascontiguousarray(plane[y : y + 9, x : x + 14]) for name, plane in mitsuba(at).items()}
        display = Window(0, 0, SHAPE[1], SHAPE[0])
        (tmp_path / f"{at.number}.exr").write_bytes(exr_bytes(planes, MITSUBA_HEADER, (x, y), display))
    frames = open_sequence(tmp_path)
    assert frames.window == Window(0, 0, 26, 12)
    for frame, at, (x, y) in zip(frames, moments(), ((0, 0), (7, 3), (12, 0)), strict=True):
        inside = np.s_[y : y + 9, x : x + 14]
        np.testing.assert_allclose(frame.motion[inside], at.frame.motion[inside], atol=1e-4)
        np.testing.assert_allclose(frame.depth[inside], at.frame.depth[inside], atol=5e-6)
        outside = np.ones(frame.shape, bool)
        outside[inside] = False
        assert np.isinf(frame.depth[outside]).all()
    following = frames.motion_to_next(frames.read(0))
    np.testing.assert_allclose(following[:9, :14, :2], moments()[0].to_next[:9, :14], atol=1e-4)


@pytest.mark.parametrize(
    ("lost", "words"),
    [
        (("nn",), "expected normal in a file of Mitsuba 3, .*; add nn:sh_normal to the aovs"),
        (("pp", "dd"), "expected depth, motion in a file of Mitsuba 3, .*; add pp:position to the aovs"),
        (("R", "G", "B", "A", "img"), "expected color in a file of Mitsuba 3"),
    ],
)
def test_a_missing_pass_is_named_with_the_aov_that_has_it(lost: tuple[str, ...], words: str, tmp_path: Path) -> None:
    cameras_file(tmp_path, BEFORE)
    with pytest.raises(FileError, match=rf"cbox\.0001\.exr: {words}"):
        open_sequence(shot(tmp_path, *lost))[0]


def test_missing_cameras_are_asked_for(tmp_path: Path) -> None:
    with pytest.raises(FileError, match=r"expected depth, motion in .*; give the camera of each frame in cameras.json"):
        open_sequence(shot(tmp_path))[0]
    cameras_file(tmp_path, (1, 3))
    frames = open_sequence(tmp_path)
    assert frames[0].depth.any()
    with pytest.raises(FileError, match=r"cbox\.0002\.exr: .*give the camera of each frame"):
        frames[1]


def test_the_beauty_may_be_in_a_layer_alone(tmp_path: Path) -> None:
    cameras_file(tmp_path, BEFORE)
    frames = open_sequence(shot(tmp_path, *"RGBA"))
    assert frames.reading.picture == ("img.R", "img.G", "img.B")
    np.testing.assert_array_equal(frames[0].color, moments()[0].frame.color)


def test_shapes_are_ids_where_the_user_says_so(tmp_path: Path) -> None:
    """Mitsuba may number them anew in every frame."""
    cameras_file(tmp_path, BEFORE)
    frames = open_sequence(shot(tmp_path), passes={"id": "idx"})
    np.testing.assert_array_equal(frames[0].id, moments()[0].frame.id, strict=True)


SAMPLE = Path(__file__).parents[5] / "shared" / "samples" / "mitsuba" / "noisy"


@pytest.mark.skipif(not SAMPLE.exists(), reason=f"{SAMPLE} is not here")
def test_motion_of_frames_of_mitsuba_leads_to_where_the_same_was_seen() -> None:
    """Depth and normal at the other end are what the third component and the surface say, but for edges and jitter."""
    frames = open_sequence(SAMPLE)
    now, before = frames[4], frames[3]
    y, x = np.indices(now.shape)
    column, row = (np.rint(a + now.motion[..., i]).astype(int) for i, a in enumerate((x, y)))
    seen = (column >= 0) & (column < now.shape[1]) & (row >= 0) & (row < now.shape[0]) & np.isfinite(now.depth)
    depth = before.depth[row[seen], column[seen]]
    expected = (now.depth + now.motion[..., 2])[seen]
    assert np.median(np.abs(depth / expected - 1)) < 5e-3
    assert np.abs(now.motion[..., :2]).max() > 1.0
