"""Frame: what is missing or does not fit is refused with the field's name, what was expected and what came."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pyopencl as cl
import pyopencl.array as cl_array
import pytest

from svgf_cl import Frame, FrameError
from svgf_cl.frame import ALPHA, CHANNELS, REQUIRED
from tests.arrays import fetched
from tests.frames import TINY, bumpy, only, wall

FRAME = bumpy(np.random.default_rng(0), TINY)


def refused(frame: Frame, field: str, expected: str, got: str) -> None:
    with pytest.raises(FrameError) as error:
        frame.check(TINY)
    assert error.value.field == field
    assert str(error.value) == f"Frame.{field}: expected {expected}, got {got}"


def test_every_field_at_once_is_fine() -> None:
    FRAME.check(TINY)
    assert list(FRAME.present()) == [name for name in Frame.__dataclass_fields__ if getattr(FRAME, name) is not None]
    assert FRAME.shape == TINY


@pytest.mark.parametrize("name", REQUIRED)
def test_required_field_is_missed(name: str) -> None:
    refused(replace(FRAME, **{name: None}), name, "an array", "nothing")


@pytest.mark.parametrize("name", ["direct", "indirect"])
def test_half_a_pair_is_refused(name: str) -> None:
    refused(replace(FRAME, **{name: None}), name, "both of direct and indirect, or neither", "nothing")


def test_some_light_is_needed() -> None:
    refused(only(FRAME, ()), "color", "an array (or direct and indirect instead)", "nothing")


@pytest.mark.parametrize("name", CHANNELS)
def test_shape_must_fit(name: str) -> None:
    value = getattr(FRAME, name)
    for wrong in (value[:-1], value[:, :-1], value[..., None], value.swapaxes(0, 1), value[0]):
        with pytest.raises(FrameError, match=rf"Frame\.{name}: expected shape \(7, 9.* got shape") as error:
            replace(FRAME, **{name: wrong}).check(TINY)
        assert str(error.value).endswith(str(wrong.shape))


def test_motion_may_have_two_components_or_three() -> None:
    only(FRAME, ("color",), motion=2).check(TINY)
    refused(only(FRAME, ("color",), motion=1), "motion", "shape (7, 9, 2) or (7, 9, 3)", "shape (7, 9, 1)")


@pytest.mark.parametrize("name", CHANNELS)
def test_type_must_fit(name: str) -> None:
    wrong = [bool, complex, float if name == "id" else int]
    kind = "integers (uint32)" if name == "id" else "floating point (float32)"
    for dtype in wrong:
        changed = np.zeros(getattr(FRAME, name).shape, dtype)
        refused(replace(FRAME, **{name: changed}), name, kind, f"dtype {changed.dtype}")


@pytest.mark.parametrize("value", [1.0, [[0.5]], "depth"])
def test_what_is_no_array_is_refused(value: Any) -> None:
    refused(replace(FRAME, depth=value), "depth", "a numpy.ndarray or pyopencl.array.Array", type(value).__name__)


def test_shape_comes_from_depth() -> None:
    with pytest.raises(FrameError, match=r"Frame\.depth: expected an array of shape \(H, W\), got shape \(7, 9, 1\)"):
        _ = replace(wall(TINY), depth=np.ones((*TINY, 1))).shape


class TestOf:
    """Frame.of: arrays of any library."""

    def test_it_is_the_frame_of_the_same_arrays(self, queue: cl.CommandQueue) -> None:
        given = FRAME.present() | {"depth": FRAME.depth.tolist(), "albedo": cl_array.to_device(queue, FRAME.albedo)}
        frame = Frame.of(**given)
        assert frame.albedo is given["albedo"]
        assert frame.normal is FRAME.normal
        np.testing.assert_array_equal(frame.depth, FRAME.depth)
        frame.check(TINY)

    def test_none_is_no_field(self) -> None:
        assert list(Frame.of(color=FRAME.color, albedo=None).present()) == ["color"]

    def test_a_buffer_of_ids_holds_integers(self, queue: cl.CommandQueue) -> None:
        buffer = cl.Buffer(queue.context, cl.mem_flags.COPY_HOST_PTR, hostbuf=FRAME.id)
        frame = Frame.of(id=(buffer, TINY), depth=(buffer, TINY))
        assert (frame.id.dtype, frame.depth.dtype) == (np.uint32, np.float32)

    @pytest.mark.parametrize("on", ["host", "device"])
    @pytest.mark.parametrize("name", [name for name, channels in CHANNELS.items() if channels == (3,)])
    def test_a_fourth_channel_is_left_out_but_for_alpha(self, name: str, on: str, queue: cl.CommandQueue) -> None:
        padded = np.concatenate([getattr(FRAME, name), np.full((*TINY, 1), 9, np.float32)], axis=-1)
        frame = Frame.of(**FRAME.present() | {name: cl_array.to_device(queue, padded) if on == "device" else padded})
        frame.check(TINY)
        wanted = padded if name == "color" else getattr(FRAME, name)
        np.testing.assert_array_equal(fetched(getattr(frame, name)), wanted, strict=True)

    @pytest.mark.parametrize(("name", "channels"), [("motion", 4), ("hit_distance", 4), ("normal", 5), ("depth", 2)])
    def test_other_channels_are_refused(self, name: str, channels: int) -> None:
        frame = Frame.of(**FRAME.present() | {name: np.zeros((*TINY, channels), np.float32)})
        with pytest.raises(FrameError, match=rf"Frame\.{name}: expected shape .*, got shape \(7, 9, {channels}\)"):
            frame.check(TINY)

    def test_the_field_is_named(self) -> None:
        with pytest.raises(FrameError, match=r"^Frame\.normal: expected an array"):
            Frame.of(color=FRAME.color, normal="normal")

    def test_a_field_that_there_is_not_is_refused(self) -> None:
        with pytest.raises(TypeError, match="colour"):
            Frame.of(colour=FRAME.color)


def test_color_may_have_alpha() -> None:
    rgba = np.concatenate([FRAME.color, np.full((*TINY, 1), 0.25, np.float32)], axis=-1)
    frame = replace(FRAME, color=rgba)
    frame.check(TINY)
    assert (frame.has_alpha, FRAME.has_alpha, only(FRAME, ()).has_alpha) == (True, False, False)
    np.testing.assert_array_equal(frame.layer("color"), FRAME.color)
    np.testing.assert_array_equal(frame.layer(ALPHA), rgba[..., 3])
    assert FRAME.layer("color") is FRAME.color
