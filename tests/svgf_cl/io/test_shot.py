"""Frames of a shot lie on one window, and have one format and the same fields."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from svgf_cl import FileError, Frame, open_sequence
from svgf_cl.io.exr import read_image, write_image
from svgf_cl.io.frames import frame_path, read_frame, write_frame
from svgf_cl.io.sequence import find_frames
from svgf_cl.io.shot import Shot, shared_window
from svgf_cl.io.window import Window
from tests.exr_files import exr_bytes
from tests.frames import wall
from tests.renderers import (
    ARNOLD_HEADER,
    BLENDER_HEADER,
    NUMBERS,
    SHAPE,
    arnold,
    blender,
    matrices,
    moments,
    own,
    same_frames,
    written,
)


def plain_frame(h: int = 3, w: int = 4, **fields: object) -> Frame:
    """An empty sky, with any field replaced or added."""
    return wall((h, w), **{"depth": np.inf, **fields})


def frames_in(folder: Path) -> list[Frame]:
    return list(Shot(find_frames([folder])))


def test_frames_of_a_sequence_have_one_size(tmp_path: Path) -> None:
    write_frame(frame_path(tmp_path, 0), plain_frame(3, 4))
    write_frame(frame_path(tmp_path, 1), plain_frame(4, 4))
    with pytest.raises(FileError, match=r"frame\.0001\.exr: expected .* 4x3 at 0,0 and .*0000\.exr, got 4x4"):
        frames_in(tmp_path)


def test_frames_of_a_sequence_have_the_fields_of_the_first(tmp_path: Path) -> None:
    """What a later frame lacks is an error; what it has beyond them is not read."""
    radiance = np.ones((3, 4, 3), np.float32)
    flat = plain_frame(albedo=radiance)
    flat = replace(flat, motion=np.ascontiguousarray(flat.motion[..., :2]))
    write_frame(frame_path(tmp_path, 0), flat)
    write_frame(frame_path(tmp_path, 1), replace(flat, albedo=None, emission=radiance))
    with pytest.raises(FileError, match=r"1\.exr: expected .*0000\.exr, got a frame without albedo"):
        frames_in(tmp_path)
    write_frame(frame_path(tmp_path, 1), plain_frame(albedo=radiance, emission=radiance))
    assert all(frame.emission is None and frame.motion.shape == (3, 4, 2) for frame in frames_in(tmp_path))


@pytest.mark.parametrize("field", ["color", "depth", "normal"])
def test_a_field_of_nothing_but_nan_is_refused(tmp_path: Path, field: str) -> None:
    frame = plain_frame()
    write_frame(frame_path(tmp_path, 0), plain_frame(**{field: np.full_like(getattr(frame, field), np.nan)}))
    with pytest.raises(FileError, match=rf"0000\.exr: expected finite values in {field}"):
        frames_in(tmp_path)


def test_a_sequence_of_nothing_but_sky_is_fine(tmp_path: Path) -> None:
    write_frame(frame_path(tmp_path, 0), plain_frame())
    assert len(frames_in(tmp_path)) == 1


def on_window(path: Path, frame: Frame, at: tuple[int, int], display: Window, aspect: float = 1.0) -> None:
    """Write a frame whose upper left pixel is at a place."""
    write_frame(path, frame)
    path.write_bytes(exr_bytes(read_image(path).planes, at=at, display=display, aspect=aspect))


def test_a_frame_shows_nothing_outside_of_its_data_window(tmp_path: Path) -> None:
    frame, display = (
        plain_frame(albedo=np.full((3, 4, 3), 0.5, np.float32), id=np.full((3, 4), 7, np.uint32)),
        Window(0, 0, 8, 8),
    )
    on_window(tmp_path / "frame.0000.exr", frame, (0, 0), display)
    on_window(tmp_path / "frame.0001.exr", frame, (-2, 6), display)
    files = find_frames([tmp_path])
    assert shared_window(files) == Window(-2, 0, 6, 9)
    nothing = {"depth": np.inf, "albedo": 1.0}
    for found, inside in zip(frames_in(tmp_path), (np.s_[:3, 2:], np.s_[6:, :4]), strict=True):
        assert found.shape == (9, 6)
        outside = np.ones(found.shape, bool)
        outside[inside] = False
        for name, value in found.present().items():
            np.testing.assert_array_equal(value[inside], getattr(frame, name), strict=True)
            assert (value[outside] == nothing.get(name, 0.0)).all()


@pytest.mark.parametrize(
    ("at", "display", "aspect", "words"),
    [
        ((0, 0), Window(0, 0, 9, 8), 1.0, "got 9x8 at 0,0 and 1"),
        ((0, 0), Window(1, 0, 8, 8), 1.0, "got 8x8 at 1,0 and 1"),
        ((0, 0), Window(0, 0, 8, 8), 2.0, "got 8x8 at 0,0 and 2"),
        (
            (10**8, -(10**8)),
            Window(0, 0, 8, 8),
            1.0,
            "expected a data window near 4x3 at 0,0, .*too many pixels",
        ),
    ],
)
def test_frames_that_cannot_be_one_shot_are_named(
    at: tuple[int, int], display: Window, aspect: float, words: str, tmp_path: Path
) -> None:
    on_window(tmp_path / "frame.0000.exr", plain_frame(), (0, 0), Window(0, 0, 8, 8))
    on_window(tmp_path / "frame.0001.exr", plain_frame(), at, display, aspect)
    with pytest.raises(FileError, match=words) as error:
        frames_in(tmp_path)
    assert all(str(tmp_path / f"frame.000{index}.exr") in str(error.value) for index in range(2))


def test_integers_beyond_what_floats_can_count_to_are_ids(tmp_path: Path) -> None:
    write_frame(tmp_path / "a.exr", plain_frame(id=np.ones((3, 4), np.uint32)))
    image, ids = read_image(tmp_path / "a.exr"), np.arange(2**32 - 12, 2**32, dtype=np.uint32).reshape(3, 4)
    write_image(
        tmp_path / "a.exr", replace(image, parts=(replace(image.parts[0], planes={**image.planes, "id": ids}),))
    )
    np.testing.assert_array_equal(read_frame(tmp_path / "a.exr").id, ids, strict=True)


# What `open_sequence` takes


def test_a_shot_is_a_sequence(tmp_path: Path) -> None:
    written(tmp_path, {at.number: own(at) for at in moments()})
    frames = open_sequence(tmp_path)
    assert (len(frames), frames.shape) == (3, SHAPE)
    same_frames(frames, [at.frame for at in moments()])
    same_frames(frames[1:], [at.frame for at in moments()[1:]])
    same_frames([frames[-1]], [moments()[-1].frame])
    with pytest.raises(IndexError):
        frames[3]


def test_frames_are_given_by_folder_pattern_or_one_by_one(tmp_path: Path) -> None:
    written(tmp_path, {at.number: own(at) for at in moments()})
    files = sorted(tmp_path.iterdir())
    for given in (tmp_path, str(tmp_path), tmp_path / "shot_####.exr", f"{tmp_path}/shot_%04d.exr", files[::-1]):
        assert list(open_sequence(given).paths) == files
    with pytest.raises(FileError, match=r"none\.####\.exr: expected files of this pattern, found none"):
        open_sequence(tmp_path / "none.####.exr")


def test_a_gap_is_a_cut_where_it_is_allowed(tmp_path: Path) -> None:
    written(tmp_path, {at.number: own(at) for at in moments((1, 2, 4))})
    with pytest.raises(FileError, match=r"shot_0003\.exr: expected this frame between"):
        open_sequence(tmp_path)
    assert open_sequence(tmp_path, allow_gaps=True).cuts == {2}


def test_a_camera_in_a_header_is_that_of_the_whole_image(tmp_path: Path) -> None:
    """Whatever part of it the data window of a frame is."""
    for at, x in zip(moments(), (0, 5, 3), strict=True):
        planes = {name: np.ascontiguousarray(plane[:, x : x + 20]) for name, plane in arnold(at).items()}
        header, display = ARNOLD_HEADER | matrices(at, "Arnold"), Window(0, 0, SHAPE[1], SHAPE[0])
        (tmp_path / f"{at.number}.exr").write_bytes(exr_bytes(planes, header, (x, 0), display))
    frames = open_sequence(tmp_path)
    for index, x in ((1, 5), (2, 3)):
        inside = np.s_[:, x : x + 20]
        np.testing.assert_allclose(frames[index].motion[inside], moments()[index].frame.motion[inside], atol=1e-3)


def test_a_display_window_elsewhere_moves_no_camera(tmp_path: Path) -> None:
    for at in moments():
        header, display = ARNOLD_HEADER | matrices(at, "Arnold"), Window(100, -50, SHAPE[1], SHAPE[0])
        (tmp_path / f"{at.number}.exr").write_bytes(exr_bytes(arnold(at), header, (100, -50), display))
    np.testing.assert_allclose(open_sequence(tmp_path)[1].motion, moments()[1].frame.motion, atol=1e-3)


def test_cameras_that_are_given_come_before_those_of_files(tmp_path: Path) -> None:
    planes = {at.number: arnold(at) for at in moments()}
    written(tmp_path, planes, {at.number: ARNOLD_HEADER | matrices(at, "Arnold") for at in moments()})
    still = dict.fromkeys(NUMBERS, moments()[0].camera)
    np.testing.assert_allclose(open_sequence(tmp_path, cameras=still)[1].motion, 0.0, atol=1e-4)
    assert np.abs(open_sequence(tmp_path)[1].motion).max() > 0.1


def test_lights_lie_on_the_window_of_the_shot(tmp_path: Path) -> None:
    display = Window(0, 0, SHAPE[1], SHAPE[0])
    for at, x in zip(moments(), (0, 12, 6), strict=True):
        planes = {name: np.ascontiguousarray(plane[:, x : x + 20]) for name, plane in blender(at).items()}
        (tmp_path / f"{at.number}.exr").write_bytes(exr_bytes(planes, BLENDER_HEADER, (x, 0), display))
    shot = open_sequence(tmp_path)
    source = shot.read(1)
    for light in source.lights:
        assert light.radiance.shape == (*SHAPE, 3)
        assert not light.radiance[:, :12].any()
    total = sum(light.radiance * (1 if light.factor is None else light.factor) for light in source.lights)
    np.testing.assert_allclose(total, source.frame.color, rtol=1e-5, atol=1e-6)
