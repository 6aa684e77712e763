"""The way in and out: every kind of array that is taken gives the same picture, all else is refused by name."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pyopencl as cl
import pyopencl.array as cl_array
import pyopencl.tools as cl_tools
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from svgf_cl import Denoiser, Frame, FrameError, SvgfError
from svgf_cl.buffers import Buffers
from svgf_cl.frame import CHANNELS
from svgf_cl.passes import Inputs, persistent_buffers, pipeline
from svgf_cl.planes import Layout
from svgf_cl.settings import Settings
from tests.frames import FULL, PLAIN, SHAPE, bumpy_sequence, wall

FRAME = bumpy_sequence(FULL, count=1)[0]
OUT = (*SHAPE, 3)


@pytest.fixture
def den(queue: cl.CommandQueue) -> Denoiser:
    return Denoiser(SHAPE, queue=queue)


@pytest.fixture(scope="module")
def expected() -> np.ndarray:
    return Denoiser(SHAPE).denoise(FRAME)


def mapped(frame: Frame, change: Callable[[np.ndarray], Any]) -> Frame:
    """The frame with every field changed."""
    return replace(frame, **{name: change(value) for name, value in frame.present().items()})


def on_device(frame: Frame, queue: cl.CommandQueue) -> Frame:
    return mapped(frame, lambda value: cl_array.to_device(queue, value))


def strided(value: np.ndarray) -> np.ndarray:
    """The same values as every other element of a larger array."""
    return np.repeat(value, 2, axis=1)[:, ::2]


def read_only(value: np.ndarray) -> np.ndarray:
    value = value.copy()
    value.flags.writeable = False
    return value


def big_endian(value: np.ndarray) -> np.ndarray:
    return value.astype(value.dtype.newbyteorder(">"))


class TestInput:
    @pytest.mark.parametrize("change", [np.asfortranarray, strided, read_only, big_endian])
    def test_layout_in_memory_does_not_matter(self, change: Callable, den: Denoiser, expected: np.ndarray) -> None:
        assert_array_equal(den.denoise(mapped(FRAME, change)), expected)

    @pytest.mark.parametrize(("real", "whole"), [(np.float64, np.int64), (np.float64, np.uint8)])
    def test_wider_types_are_rounded(self, real: type, whole: type, den: Denoiser, expected: np.ndarray) -> None:
        wide = mapped(FRAME, lambda value: value.astype(real if value.dtype.kind == "f" else whole))
        assert_array_equal(den.denoise(wide), expected)

    def test_half_floats_are_widened(self, den: Denoiser) -> None:
        half = mapped(FRAME, lambda value: value.astype(np.float16) if value.dtype.kind == "f" else value)
        single = mapped(half, lambda value: value.astype(np.float32) if value.dtype.kind == "f" else value)
        assert_array_equal(den.denoise(half), Denoiser(SHAPE).denoise(single))

    def test_arrays_on_the_device_give_one_on_the_same_queue(self, den: Denoiser, expected: np.ndarray) -> None:
        out = den.denoise(on_device(FRAME, den.queue))
        assert isinstance(out, cl_array.Array)
        assert out.queue == den.queue
        assert_array_equal(out.get(), expected)

    def test_one_numpy_field_gives_numpy(self, den: Denoiser, expected: np.ndarray) -> None:
        out = den.denoise(replace(on_device(FRAME, den.queue), depth=FRAME.depth))
        assert isinstance(out, np.ndarray)
        assert_array_equal(out, expected)

    def test_arrays_are_left_as_they_were(self, den: Denoiser) -> None:
        frame = on_device(FRAME, den.queue)
        den.denoise(frame)
        for name, value in frame.present().items():
            assert_array_equal(value.get(), getattr(FRAME, name))

    def test_numpy_fields_may_be_overwritten_afterwards(self, den: Denoiser, expected: np.ndarray) -> None:
        frame = mapped(FRAME, np.copy)
        out = cl_array.empty(den.queue, OUT, np.float32)
        den.denoise(frame, out=out)
        for value in frame.present().values():
            value.fill(0)
        assert_array_equal(out.get(), expected)

    @pytest.mark.parametrize("name", ["color", "depth", "id"])
    def test_array_of_another_type_is_refused(self, name: str, den: Denoiser) -> None:
        other = np.int64 if name == "id" else np.float64
        frame = replace(
            on_device(FRAME, den.queue), **{name: cl_array.zeros(den.queue, getattr(FRAME, name).shape, other)}
        )
        with pytest.raises(FrameError, match=rf"Frame\.{name}: expected dtype \w+32, got dtype \w+64"):
            den.denoise(frame)

    @pytest.mark.parametrize(
        "view",
        [
            lambda queue: cl_array.zeros(queue, (SHAPE[0] + 1, SHAPE[1]), np.float32)[1:],
            lambda queue: cl_array.zeros(queue, (SHAPE[0], 2 * SHAPE[1]), np.float32)[:, ::2],
            lambda queue: cl_array.zeros(queue, SHAPE, np.float32, order="F"),
        ],
        ids=["offset", "strided", "Fortran"],
    )
    def test_view_of_an_array_is_refused(self, view: Callable, den: Denoiser) -> None:
        with pytest.raises(
            FrameError, match=r"Frame\.depth: expected a C-contiguous Array with offset 0 .*, got a view"
        ):
            den.denoise(replace(on_device(FRAME, den.queue), depth=view(den.queue)))

    def test_array_on_another_context_is_refused(self, den: Denoiser) -> None:
        other = cl.Context([den.queue.device])  # held here: on Intel's runtime a queue does not keep its context
        stranger = cl.CommandQueue(other)
        with pytest.raises(FrameError, match=r"Frame\.color: .* context"):
            den.denoise(on_device(FRAME, stranger))

    @pytest.mark.parametrize("name", CHANNELS)
    def test_field_of_a_wrong_shape_is_refused(self, name: str, den: Denoiser) -> None:
        with pytest.raises(FrameError, match=rf"Frame\.{name}: expected shape"):
            den.denoise(replace(wall(direct=0, indirect=0), **{name: np.zeros((3, 3), np.float32)}))

    def test_other_fields_need_a_reset(self, den: Denoiser) -> None:
        frame = wall()
        den.denoise(frame)
        with pytest.raises(FrameError, match=r"Frame\.fields: expected .*, motion \(.* reset, got .*, albedo"):
            den.denoise(FRAME)
        den.reset()
        assert_array_equal(den.denoise(FRAME), Denoiser(SHAPE).denoise(FRAME))

    def test_refused_frame_leaves_the_history_alone(self, den: Denoiser) -> None:
        frames = bumpy_sequence(PLAIN, count=2)
        den.denoise(frames[0])
        for bad in (FRAME, replace(frames[1], depth=None), replace(frames[1], color=np.zeros((2, 2, 3)))):
            with pytest.raises(FrameError):
                den.denoise(bad)
        other = Denoiser(SHAPE)
        other.denoise(frames[0])
        assert_array_equal(den.denoise(frames[1]), other.denoise(frames[1]))


class TestOutput:
    def test_numpy_out_is_filled_and_returned(self, den: Denoiser, expected: np.ndarray) -> None:
        out = np.full(OUT, np.nan, np.float32)
        assert den.denoise(FRAME, out=out) is out
        assert_array_equal(out, expected)

    def test_array_out_is_filled_and_returned(self, den: Denoiser, expected: np.ndarray) -> None:
        out = cl_array.empty(den.queue, OUT, np.float32)
        assert den.denoise(FRAME, out=out) is out
        assert_array_equal(out.get(), expected)

    def test_numpy_out_of_arrays(self, den: Denoiser, expected: np.ndarray) -> None:
        out = np.empty(OUT, np.float32)
        den.denoise(on_device(FRAME, den.queue), out=out)
        assert_array_equal(out, expected)

    def test_results_do_not_share_memory(self, den: Denoiser) -> None:
        first = den.denoise(FRAME)
        kept = first.copy()
        den.denoise(wall(emission=0, albedo=1, id=1))
        assert_array_equal(first, kept)

    @pytest.mark.parametrize(
        ("out", "message"),
        [
            ([1.0], r"expected a numpy.ndarray or pyopencl.array.Array, got list"),
            (np.empty(SHAPE, np.float32), r"expected shape \(53, 37, 3\), float32, got shape \(53, 37\), float32"),
            (np.empty(OUT, np.float64), r"expected shape .*, float32, got shape \(53, 37, 3\), float64"),
            (np.empty(OUT[::-1], np.float32).T, r"expected a writable C-contiguous array"),
            (read_only(np.empty(OUT, np.float32)), r"expected a writable C-contiguous array"),
        ],
        ids=["list", "shape", "type", "order", "read-only"],
    )
    def test_what_cannot_be_written_is_refused(self, out: Any, message: str, den: Denoiser) -> None:
        with pytest.raises(FrameError, match=rf"^Frame\.out: {message}"):
            den.denoise(FRAME, out=out)

    def test_array_with_an_offset_is_refused(self, den: Denoiser) -> None:
        out = cl_array.zeros(den.queue, (SHAPE[0] + 1, SHAPE[1], 3), np.float32)[1:]
        with pytest.raises(FrameError, match=r"Frame\.out: .*offset 0"):
            den.denoise(FRAME, out=out)


def test_waits_for_events_before_arrays_are_read(den: Denoiser, expected: np.ndarray) -> None:
    frame = on_device(replace(FRAME, color=np.zeros_like(FRAME.color)), den.queue)
    den.queue.finish()
    go = cl.UserEvent(den.queue.context)
    renderer = cl.CommandQueue(den.queue.context)
    rendered = cl.enqueue_copy(renderer, frame.color.base_data, FRAME.color, wait_for=[go], is_blocking=False)
    renderer.flush()
    out = den.denoise(frame, wait_for=[rendered])
    go.set_status(cl.command_execution_status.COMPLETE)
    assert_array_equal(out.get(), expected)


class TestBuffers:
    INPUTS = Inputs.of(FRAME)
    PASSES = pipeline(INPUTS, Settings(taa=True))
    LAYOUT = Layout(*SHAPE)

    @pytest.fixture
    def buffers(self, queue: cl.CommandQueue) -> Buffers:
        return Buffers(queue, self.LAYOUT, self.PASSES, self.INPUTS, share=True)

    def test_history_begins_blank(self, buffers: Buffers) -> None:
        for name in persistent_buffers(self.PASSES):
            assert_array_equal(buffers.read(name), np.float32(np.nan if "antialiased" in name else 0))

    def test_nbytes_is_all_memory(self, buffers: Buffers) -> None:
        names = {name for step in self.PASSES for name in (*step.reads, *step.writes)} - {*self.INPUTS.fields, "out"}
        assert buffers.nbytes == sum(b.size for b in {buffers[name].int_ptr: buffers[name] for name in names}.values())

    def test_what_was_written_becomes_history(self, buffers: Buffers) -> None:
        guide, previous = buffers["guide"], buffers["previous guide"]
        buffers.begin_frame()
        assert (buffers["guide"], buffers["previous guide"]) == (previous, guide)

    def test_last_owner_of_shared_memory_survives(self, buffers: Buffers) -> None:
        assert buffers.survives("guide")
        assert buffers.survives("modulated") or buffers.survives("level 5")
        assert not buffers.survives("demodulated")

    def test_without_sharing_all_survive(self, queue: cl.CommandQueue) -> None:
        buffers = Buffers(queue, self.LAYOUT, self.PASSES, self.INPUTS, share=False)
        assert all(buffers.survives(name) for step in self.PASSES for name in step.writes if name != "out")


def test_too_large_an_image_is_refused_with_its_size() -> None:
    with pytest.raises(SvgfError, match=r"no room for a buffer of \d+ MiB"):
        Buffers(Denoiser((1, 1)).queue, Layout(1 << 18, 1 << 18), TestBuffers.PASSES, TestBuffers.INPUTS, share=True)


def test_values_beyond_float32_are_no_light(den: Denoiser) -> None:
    color = np.full(OUT, 1e300)
    assert_allclose(den.denoise(replace(wall(), color=color)), 0)


@pytest.mark.parametrize("side", [17_000, 10**6])
def test_image_beyond_32_bit_indices_is_refused(side: int, queue: cl.CommandQueue) -> None:
    with pytest.raises(SvgfError, match="at most about 16000 x 16000"):
        Denoiser((side, side), queue=queue)


def test_arrays_from_a_memory_pool_are_taken(expected: np.ndarray, den: Denoiser) -> None:
    pool = cl_tools.MemoryPool(cl_tools.ImmediateAllocator(den.queue))
    frame = mapped(FRAME, lambda value: cl_array.to_device(den.queue, value, allocator=pool))
    assert_array_equal(den.denoise(frame).get(), expected)


@pytest.mark.parametrize("name", ["color", "normal", "emission"])
def test_result_must_not_overwrite_a_field(name: str, den: Denoiser) -> None:
    frame = on_device(FRAME, den.queue)
    with pytest.raises(FrameError, match=rf"out: expected memory of its own, got that of {name}"):
        den.denoise(frame, out=getattr(frame, name))


def test_a_field_still_being_computed_on_another_queue_is_waited_for(expected: np.ndarray, den: Denoiser) -> None:
    renderer = cl.CommandQueue(den.queue.context)
    frame = on_device(replace(FRAME, color=np.zeros_like(FRAME.color)), den.queue)
    den.queue.finish()
    go = cl.UserEvent(den.queue.context)
    rendered = cl.enqueue_copy(renderer, frame.color.base_data, FRAME.color, wait_for=[go], is_blocking=False)
    frame.color.add_event(rendered)
    out = den.denoise(frame)
    go.set_status(cl.command_execution_status.COMPLETE)
    assert_array_equal(out.get(), expected)


def test_a_result_knows_when_it_is_ready(den: Denoiser) -> None:
    out = den.denoise(on_device(FRAME, den.queue))
    assert out.events
    cl.wait_for_events(out.events)


def test_an_out_of_order_queue_is_refused(queue: cl.CommandQueue) -> None:
    unordered = cl.command_queue_properties.OUT_OF_ORDER_EXEC_MODE_ENABLE
    if not queue.device.queue_properties & unordered:
        pytest.skip(f"{queue.device.name} has no out-of-order queues")
    with pytest.raises(SvgfError, match="in-order"):
        Denoiser(SHAPE, queue=cl.CommandQueue(queue.context, properties=unordered))


@pytest.mark.parametrize("settings", [{"taa": True}, "fast", {}])
def test_settings_must_be_settings(settings: Any, queue: cl.CommandQueue) -> None:
    with pytest.raises(SvgfError, match="expected settings="):
        Denoiser(SHAPE, queue=queue, settings=settings)


def test_a_refused_first_frame_leaves_no_trace(expected: np.ndarray, den: Denoiser) -> None:
    with pytest.raises(FrameError):
        den.denoise(wall(), out=np.empty((1, 1), np.float32))
    assert_array_equal(den.denoise(FRAME), expected)
