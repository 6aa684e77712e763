"""Frames of a shot lie on one window, and have one format and the same fields."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from svgf_cl import FileError, Frame
from svgf_cl.io.exr import read_image, write_image
from svgf_cl.io.frames import frame_path, read_frame, write_frame
from svgf_cl.io.sequence import find_frames
from svgf_cl.io.shot import Shot, shared_window
from svgf_cl.io.window import Window
from tests.exr_files import exr_bytes
from tests.frames import wall


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
