"""The way in and out: every kind of array that is taken gives the same picture, all else is refused by name."""

from __future__ import annotations

import sys
import threading
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pyopencl as cl
import pyopencl.array as cl_array
import pyopencl.tools as cl_tools
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from svgf_cl import ArgumentError, Denoiser, Frame, FrameError, Settings
from svgf_cl.device import user_arrays
from svgf_cl.frame import CARRIED, CHANNELS
from tests.arrays import big_endian, mapped_file, read_only, strided, unaligned
from tests.frames import FULL, PLAIN, SHAPE, bumpy_sequence, wall

FRAME = bumpy_sequence(FULL, count=1)[0]
OUT = (*SHAPE, 3)


@pytest.fixture(params=["usual", "copied"])
def den(queue: cl.CommandQueue, request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> Denoiser:
    """Treats numpy arrays as suits the device; and by copies, as on a GPU."""
    if request.param == "copied":
        monkeypatch.setattr(user_arrays, "shares_memory", lambda device: False)
    return Denoiser(SHAPE, queue=queue)


@pytest.fixture
def in_place(queue: cl.CommandQueue) -> Denoiser:
    """Works on numpy arrays where they lie."""
    if not user_arrays.shares_memory(queue.device):
        pytest.skip(f"{queue.device.name} has memory of its own")
    return Denoiser(SHAPE, queue=queue)


@pytest.fixture(scope="module")
def expected() -> np.ndarray:
    return Denoiser(SHAPE).denoise(FRAME)


def mapped(frame: Frame, change: Callable[[np.ndarray], Any]) -> Frame:
    """The frame with every field changed."""
    return replace(frame, **{name: change(value) for name, value in frame.present().items()})


def on_device(frame: Frame, queue: cl.CommandQueue) -> Frame:
    return mapped(frame, lambda value: cl_array.to_device(queue, value))


class TestInput:
    @pytest.mark.parametrize("change", [np.asfortranarray, strided, read_only, unaligned, big_endian])
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

    @pytest.mark.parametrize("name", [name for name in CHANNELS if name not in CARRIED])
    def test_field_of_a_wrong_shape_is_refused(self, name: str, den: Denoiser) -> None:
        with pytest.raises(FrameError, match=rf"Frame\.{name}: expected shape"):
            den.denoise(replace(wall(direct=0, indirect=0), **{name: np.zeros((3, 3), np.float32)}))

    def test_other_fields_need_a_reset(self, den: Denoiser) -> None:
        frame = wall()
        den.denoise(frame)
        with pytest.raises(ArgumentError, match=r"\(frame\): expected .*, motion \(.* reset, got .*, albedo"):
            den.denoise(FRAME)
        den.reset()
        assert_array_equal(den.denoise(FRAME), Denoiser(SHAPE).denoise(FRAME))

    def test_refused_frame_leaves_the_history_alone(self, den: Denoiser) -> None:
        frames = bumpy_sequence(PLAIN, count=2)
        den.denoise(frames[0])
        for bad in (FRAME, replace(frames[1], depth=None), replace(frames[1], color=np.zeros((2, 2, 3)))):
            with pytest.raises((ArgumentError, FrameError)):
                den.denoise(bad)
        other = Denoiser(SHAPE)
        other.denoise(frames[0])
        assert_array_equal(den.denoise(frames[1]), other.denoise(frames[1]))


class TestInPlace:
    def test_nothing_is_copied(self, in_place: Denoiser, expected: np.ndarray, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.delattr(cl, "enqueue_copy")
        assert_array_equal(in_place.denoise(FRAME), expected)

    def test_converted_arrays_are_not_copied_again(
        self, in_place: Denoiser, expected: np.ndarray, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        monkeypatch.delattr(cl, "enqueue_copy")
        assert_array_equal(in_place.denoise(mapped(FRAME, np.asfortranarray)), expected)

    def test_pages_that_cannot_be_written_are_read(self, den: Denoiser, expected: np.ndarray, tmp_path: Path) -> None:
        fields = {name: mapped_file(value, tmp_path / name) for name, value in FRAME.present().items()}
        assert_array_equal(den.denoise(replace(FRAME, **fields)), expected)

    def test_arrays_are_let_go(self, den: Denoiser) -> None:
        frame, out = mapped(FRAME, np.copy), np.empty(OUT, np.float32)
        den.denoise(frame, out=out)
        before = {name: sys.getrefcount(value) for name, value in {"out": out, **frame.present()}.items()}
        den.denoise(FRAME, out=np.empty(OUT, np.float32))
        assert before == {name: sys.getrefcount(value) for name, value in {"out": out, **frame.present()}.items()}

    def test_one_array_may_be_several_fields(self, den: Denoiser) -> None:
        same, apart = bumpy_sequence(FULL, count=2)
        same = replace(same, emission=same.color, albedo=same.color)
        apart = mapped(same, np.copy)
        assert_array_equal(den.denoise(same), Denoiser(SHAPE).denoise(apart))

    @pytest.mark.parametrize("name", ["color", "normal", "motion", "albedo", "emission"])
    def test_result_may_take_the_place_of_a_field(self, name: str, queue: cl.CommandQueue) -> None:
        settings = Settings(taa=True)
        den, other = Denoiser(SHAPE, queue=queue, settings=settings), Denoiser(SHAPE, queue=queue, settings=settings)
        for frame in bumpy_sequence(FULL, count=3):
            frame = mapped(frame, np.copy)
            expected = other.denoise(frame)
            assert_array_equal(den.denoise(frame, out=getattr(frame, name)), expected)

    def test_result_may_overlap_a_field(self, den: Denoiser, expected: np.ndarray) -> None:
        memory = np.empty((SHAPE[0] + 3, SHAPE[1], 3), np.float32)
        albedo, out = memory[3:], memory[:-3]
        albedo[:] = FRAME.albedo
        assert_array_equal(den.denoise(replace(FRAME, albedo=albedo), out=out), expected)

    def test_unaligned_result_is_filled(self, den: Denoiser, expected: np.ndarray) -> None:
        out = unaligned(np.zeros(OUT, np.float32))
        den.denoise(FRAME, out=out)
        assert_array_equal(out, expected)

    def test_after_an_error_nothing_reads_the_arrays(self, in_place: Denoiser, monkeypatch: pytest.MonkeyPatch) -> None:
        events: list[cl.Event] = []

        def fail_after_third(_: str, event: cl.Event) -> None:
            events.append(event)
            if len(events) == 3:
                raise KeyboardInterrupt

        in_place = Denoiser(SHAPE, queue=in_place.queue, after_pass=fail_after_third)
        go = cl.UserEvent(in_place.queue.context)
        release = threading.Timer(0.1, go.set_status, [cl.command_execution_status.COMPLETE])
        release.start()
        with pytest.raises(KeyboardInterrupt):
            in_place.denoise(FRAME, wait_for=[go])
        assert [event.command_execution_status for event in events] == [cl.command_execution_status.COMPLETE] * 3


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
        with pytest.raises(ArgumentError, match=rf"^denoise\(out\): {message}"):
            den.denoise(FRAME, out=out)

    def test_array_with_an_offset_is_refused(self, den: Denoiser) -> None:
        out = cl_array.zeros(den.queue, (SHAPE[0] + 1, SHAPE[1], 3), np.float32)[1:]
        with pytest.raises(ArgumentError, match=r"denoise\(out\): .*offset 0"):
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


def test_values_beyond_float32_are_no_light(den: Denoiser) -> None:
    color = np.full(OUT, 1e300)
    assert_allclose(den.denoise(replace(wall(), color=color)), 0)


def test_arrays_from_a_memory_pool_are_taken(expected: np.ndarray, den: Denoiser) -> None:
    pool = cl_tools.MemoryPool(cl_tools.ImmediateAllocator(den.queue))
    frame = mapped(FRAME, lambda value: cl_array.to_device(den.queue, value, allocator=pool))
    assert_array_equal(den.denoise(frame).get(), expected)


@pytest.mark.parametrize("name", ["color", "normal", "emission"])
def test_result_must_not_overwrite_a_field(name: str, den: Denoiser) -> None:
    frame = on_device(FRAME, den.queue)
    with pytest.raises(ArgumentError, match=rf"out\): expected memory of its own, got that of {name}"):
        den.denoise(frame, out=getattr(frame, name))


@pytest.mark.parametrize(("offset", "apart"), [(0, False), (1, False), (2, True)])
def test_result_must_not_overlap_a_field_in_one_buffer(offset: int, apart: bool, den: Denoiser) -> None:
    half = 1 << 14  # bytes; two hold an image, and on any device a part of a buffer may begin there
    buffer = cl.Buffer(den.queue.context, cl.mem_flags.READ_WRITE, 4 * half)
    color, out = (
        cl_array.Array(den.queue, OUT, np.float32, data=buffer.get_sub_region(begin * half, 2 * half))
        for begin in (0, offset)
    )
    color.set(FRAME.color)
    frame = replace(on_device(FRAME, den.queue), color=color)
    if apart:
        assert np.isfinite(den.denoise(frame, out=out).get()).all()
        return
    with pytest.raises(ArgumentError, match=r"out\): expected memory of its own, got that of color"):
        den.denoise(frame, out=out)


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


def test_an_array_finished_on_the_same_queue_is_not_waited_for(den: Denoiser, monkeypatch: pytest.MonkeyPatch) -> None:
    frame = on_device(FRAME, den.queue)
    assert frame.color.events
    monkeypatch.delattr(cl, "enqueue_barrier")
    den.denoise(frame)


def test_a_result_knows_when_it_is_ready(den: Denoiser) -> None:
    out = den.denoise(on_device(FRAME, den.queue))
    assert out.events
    cl.wait_for_events(out.events)


def test_a_refused_first_frame_leaves_no_trace(expected: np.ndarray, den: Denoiser) -> None:
    with pytest.raises(ArgumentError):
        den.denoise(wall(), out=np.empty((1, 1), np.float32))
    assert_array_equal(den.denoise(FRAME), expected)
