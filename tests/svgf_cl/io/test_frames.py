"""Frames and pictures survive the way to an EXR file and back; what does not fit is refused with the file's name."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from svgf_cl import FileError, Frame, FrameError
from svgf_cl.frame import CARRIED, CHANNELS
from svgf_cl.io.exr import read_image, write_channels
from svgf_cl.io.frames import (
    CHANNEL_NAMES,
    MAX_ID,
    frame_path,
    kept_frame,
    read_frame,
    write_frame,
)


def floats(*shape: int) -> st.SearchStrategy[np.ndarray]:
    """Arrays of any float32 at all: infinities, NaN, subnormals, negative zero."""
    return hnp.arrays(np.float32, shape, elements=st.floats(width=32))


@st.composite
def frames(draw: st.DrawFn) -> Frame:
    h, w = draw(st.integers(1, 5)), draw(st.integers(1, 5))
    fields = {"normal": floats(h, w, 3), "depth": floats(h, w), "motion": floats(h, w, draw(st.sampled_from((2, 3))))}
    fields |= {name: floats(h, w, 3) for name in draw(st.sets(st.sampled_from(("albedo", "emission"))))}
    signals = draw(st.sampled_from((("color",), ("direct", "indirect"), ("color", "direct", "indirect"))))
    fields |= {name: floats(h, w, 3) for name in signals}
    if draw(st.booleans()):
        fields["id"] = hnp.arrays(np.uint32, (h, w), elements=st.integers(0, MAX_ID))
    return Frame(**{name: draw(value) for name, value in fields.items()})


def plain_frame(h: int = 3, w: int = 4, **fields: object) -> Frame:
    rng = np.random.default_rng(7)
    values = {name: rng.random((h, w, 3), np.float32) for name in ("color", "normal", "motion")}
    return Frame(**{**values, "depth": np.full((h, w), np.inf, np.float32), **fields})


@given(frames())
@settings(deadline=None, max_examples=40)
def test_a_frame_comes_back_bit_for_bit(frame: Frame) -> None:
    with tempfile.TemporaryDirectory() as folder:
        path = frame_path(Path(folder), 0)
        write_frame(path, frame)
        back = read_frame(path).present()
    assert back.keys() == frame.present().keys()
    for name, value in frame.present().items():
        assert back[name].dtype == value.dtype
        np.testing.assert_array_equal(back[name], value, strict=True)


def test_alpha_is_written(tmp_path: Path) -> None:
    path = tmp_path / "frame.0000.exr"
    rgba = np.random.default_rng(0).random((3, 4, 4), np.float32)
    write_frame(path, plain_frame(color=rgba))
    np.testing.assert_array_equal(read_image(path).planes["A"], rgba[..., 3])
    np.testing.assert_array_equal(read_frame(path).color, rgba[..., :3])


def test_a_great_id_is_refused_and_leaves_no_file(tmp_path: Path) -> None:
    with pytest.raises(FileError, match="expected ids up to 16777216"):
        write_frame(tmp_path / "frame.0000.exr", plain_frame(id=np.full((3, 4), MAX_ID + 1, np.uint32)))
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("value", [-1.0, 0.5, np.nan, np.inf, 2.0 * MAX_ID])
def test_an_id_that_is_no_whole_number_is_refused(tmp_path: Path, value: float) -> None:
    path = tmp_path / "frame.0000.exr"
    write_frame(path, plain_frame(id=np.ones((3, 4), np.uint32)))
    write_channels(path, {**read_image(path).planes, "id": np.full((3, 4), value, np.float32)})
    with pytest.raises(FileError, match=r"frame\.0000\.exr: expected whole numbers.*unsigned integers"):
        read_frame(path)


@pytest.mark.parametrize(
    "channel", [names[-1] for names in CHANNEL_NAMES.values() if names[-1] not in ("id", "motion.Z", "roughness")]
)
def test_an_absent_channel_is_named_with_those_found(tmp_path: Path, channel: str) -> None:
    path = tmp_path / "frame.0000.exr"
    optional = ("albedo", "emission", "direct", "indirect", *CARRIED)
    fields = {name: np.ones((3, 4, *filter(None, CHANNELS[name])), np.float32) for name in optional}
    write_frame(path, plain_frame(**fields))
    planes = read_image(path).planes
    del planes[channel]
    write_channels(path, planes)
    with pytest.raises(FileError, match=rf"frame\.0000\.exr: expected channels .*{channel}.*, found "):
        read_frame(path)


def test_a_frame_without_any_radiance_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "frame.0000.exr"
    write_frame(path, plain_frame())
    planes = {name: plane for name, plane in read_image(path).planes.items() if name not in CHANNEL_NAMES["color"]}
    write_channels(path, planes)
    with pytest.raises(FileError, match=r"frame\.0000\.exr: expected channels R G B, found .*depth\.Z"):
        read_frame(path)


def test_a_frame_of_another_renderer_is_told_all_that_is_missing_at_once(tmp_path: Path) -> None:
    plane = np.ones((3, 4), np.float32)
    write_channels(tmp_path / "a.exr", {f"L.Combined.{c}": plane for c in "RGB"} | {"L.Depth.Z": plane})
    with pytest.raises(FileError, match=r"expected channels R G B normal\.X .*--map color=L\.Combined; L\.Depth"):
        read_frame(tmp_path / "a.exr")


def test_an_inconsistent_frame_is_not_written(tmp_path: Path) -> None:
    with pytest.raises(FrameError, match=r"Frame\.albedo"):
        write_frame(tmp_path / "frame.0000.exr", plain_frame(albedo=np.ones((9, 9, 3), np.float32)))
    assert list(tmp_path.iterdir()) == []


def test_a_frame_is_kept_for_what_it_was_made_from(tmp_path: Path) -> None:
    path, frame = tmp_path / "frame.0000.exr", plain_frame()
    assert kept_frame(path, "this") is None
    write_frame(path, frame)
    assert kept_frame(path, "") is None
    write_frame(path, frame, "this")
    assert kept_frame(path, "that") is None
    kept = kept_frame(path, "this")
    for name, value in frame.present().items():
        np.testing.assert_array_equal(kept.present()[name], value, strict=True)
    path.write_bytes(path.read_bytes()[:-1])
    assert kept_frame(path, "this") is None
