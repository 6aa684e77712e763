"""Shared virtual memory: used where it lies, refused by name where a device cannot, alive as long as it is used."""

from __future__ import annotations

import threading
import weakref
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pyopencl as cl
import pyopencl.array as cl_array
import pytest
from numpy.testing import assert_array_equal
from pyopencl.tools import SVMAllocator, SVMPool

from svgf_cl import ArgumentError, Denoiser, Frame, FrameError, Inputs
from svgf_cl.check.view import on_host
from svgf_cl.device import svm, user_arrays
from svgf_cl.device.svm import InFlight, capabilities
from svgf_cl.tiled import TiledDenoiser
from tests.frames import FULL, SHAPE, bumpy_sequence

FRAME = bumpy_sequence(FULL, count=1)[0]
OUT = (*SHAPE, 3)
DONE = cl.command_execution_status.COMPLETE


@pytest.fixture
def den(queue: cl.CommandQueue) -> Denoiser:
    """On a device that has SVM."""
    if not capabilities(queue.device):
        pytest.skip(f"{queue.device.name} has no SVM")
    return Denoiser(SHAPE, queue=queue)


@pytest.fixture(scope="module")
def expected() -> np.ndarray:
    return Denoiser(SHAPE).denoise(FRAME)


def allocated(queue: cl.CommandQueue, value: np.ndarray) -> cl_array.Array:
    return cl_array.to_device(queue, value, allocator=SVMAllocator(queue.context, queue=queue))


def pooled(queue: cl.CommandQueue, value: np.ndarray) -> cl_array.Array:
    return cl_array.to_device(queue, value, allocator=SVMPool(SVMAllocator(queue.context, queue=queue)))


def of_numpy(queue: cl.CommandQueue, value: np.ndarray) -> cl_array.Array:
    """Of a numpy array in SVM, which the host maps to write to it."""
    memory = cl.csvm_empty(queue.context, value.shape, value.dtype)
    with cl.SVM(memory).map_rw(queue) as mapped:
        mapped[...] = value
    return cl_array.Array(queue, value.shape, value.dtype, data=cl.SVM(memory))


KINDS = (allocated, pooled, of_numpy)


def in_svm(frame: Frame, kind: Callable, queue: cl.CommandQueue) -> Frame:
    return replace(frame, **{name: kind(queue, value) for name, value in frame.present().items()})


@pytest.mark.parametrize("kind", KINDS)
class TestInPlace:
    def test_fields_are_read_where_they_lie(
        self, kind: Callable, den: Denoiser, expected: np.ndarray, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        frame = in_svm(FRAME, kind, den.queue)
        with monkeypatch.context() as patch:
            patch.delattr(cl, "enqueue_copy")
            patch.setattr(user_arrays, "StridedCopies", None)
            out = den.denoise(frame)
        assert isinstance(out.base_data, cl.Buffer)
        assert_array_equal(out.get(), expected)

    def test_a_result_is_written_where_it_lies(
        self, kind: Callable, den: Denoiser, expected: np.ndarray, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        out = kind(den.queue, np.zeros(OUT, np.float32))
        frame = in_svm(FRAME, kind, den.queue)
        with monkeypatch.context() as patch:
            patch.delattr(cl, "enqueue_copy")
            assert den.denoise(frame, out=out) is out
        assert_array_equal(on_host(out), expected)

    def test_beside_numpy_arrays(self, kind: Callable, den: Denoiser, expected: np.ndarray) -> None:
        out = kind(den.queue, np.zeros(OUT, np.float32))
        den.denoise(FRAME, out=out)
        assert_array_equal(on_host(out), expected)
        den.reset()
        assert_array_equal(den.denoise(replace(FRAME, color=kind(den.queue, FRAME.color))), expected)

    def test_a_part_of_it_is_copied_on_the_device(self, kind: Callable, den: Denoiser, expected: np.ndarray) -> None:
        stack = kind(den.queue, np.concatenate([FRAME.color, FRAME.normal], axis=-1))
        frame = replace(in_svm(FRAME, kind, den.queue), color=stack[..., :3], normal=stack[..., 3:])
        out = kind(den.queue, np.zeros((*SHAPE, 5), np.float32))[..., 1:4]
        den.denoise(frame, out=out)
        assert [label for label, _ in den.events if "gather" in label] == ["gather color", "gather normal"]
        assert_array_equal(on_host(out), expected)

    def test_a_result_must_not_overwrite_a_field(self, kind: Callable, den: Denoiser) -> None:
        frame = in_svm(FRAME, kind, den.queue)
        with pytest.raises(ArgumentError, match=r"out\): expected memory of its own, got that of normal"):
            den.denoise(frame, out=frame.normal)
        with pytest.raises(ArgumentError, match=r"out\): expected memory of its own, got that of normal"):
            den.denoise(frame, out=frame.normal.base_data.buf.view(np.float32)[: np.prod(OUT)].reshape(OUT))

    def test_tiles_take_no_such_array(self, kind: Callable, den: Denoiser) -> None:
        tiled = TiledDenoiser(SHAPE, Inputs.of(FRAME), queue=den.queue)
        with pytest.raises(FrameError, match=r"Frame\.depth: expected a numpy.ndarray, .* got a device array"):
            tiled.denoise(replace(FRAME, depth=kind(den.queue, FRAME.depth)))


def test_of_one_allocation_a_result_may_lie_beside_a_field(den: Denoiser, expected: np.ndarray) -> None:
    memory = cl.csvm_empty(den.queue.context, (2, *OUT), np.float32)
    color, out = (cl_array.Array(den.queue, OUT, np.float32, data=cl.SVM(part)) for part in memory)
    color.set(FRAME.color)
    den.denoise(replace(in_svm(FRAME, allocated, den.queue), color=color), out=out)
    assert_array_equal(on_host(out), expected)


def test_a_numpy_array_in_svm_is_like_any_other(den: Denoiser, expected: np.ndarray) -> None:
    color = of_numpy(den.queue, FRAME.color).base_data.mem
    assert_array_equal(den.denoise(replace(FRAME, color=color)), expected)


def of_other_memory(queue: cl.CommandQueue) -> cl_array.Array:
    """As for a device that works in all memory of the host."""
    return cl_array.Array(queue, SHAPE, np.float32, data=cl.SVM(FRAME.depth.copy()))


def test_all_memory_is_used_where_it_lies_on_a_device_that_shares_it(queue: cl.CommandQueue) -> None:
    if not capabilities(queue.device) & svm.SYSTEM:
        pytest.skip(f"{queue.device.name} does not work in all memory of the host")
    memory = {name: value.copy() for name, value in FRAME.present().items()}
    given = {
        name: cl_array.Array(queue, value.shape, value.dtype, data=cl.SVM(value)) for name, value in memory.items()
    }
    picture = np.zeros(OUT, np.float32)
    out = cl_array.Array(queue, OUT, np.float32, data=cl.SVM(picture))
    Denoiser(SHAPE, queue=queue).denoise(Frame(**given), out=out)
    cl.wait_for_events(out.events)
    assert_array_equal(picture, Denoiser(SHAPE, queue=queue).denoise(FRAME))


class TestRefused:
    @pytest.fixture
    def den(self, queue: cl.CommandQueue) -> Denoiser:
        """On any device."""
        return Denoiser(SHAPE, queue=queue)

    def test_where_a_device_has_none(self, den: Denoiser, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr(svm, "capabilities", lambda device: 0)
        words = r"Frame\.depth: expected an Array in a buffer .*, as .* has no shared virtual memory \(SVM\), got"
        with pytest.raises(FrameError, match=words):
            den.denoise(replace(FRAME, depth=of_other_memory(den.queue)))

    def test_memory_that_is_none(self, den: Denoiser) -> None:
        if capabilities(den.queue.device) & svm.SYSTEM:
            pytest.skip(f"all memory is SVM for {den.queue.device.name}")
        words = r"Frame\.depth: expected .*, as .* (has no shared virtual|does not work in the host's other) memory"
        with pytest.raises(FrameError, match=words):
            den.denoise(replace(FRAME, depth=of_other_memory(den.queue)))

    def test_of_another_context(self, den: Denoiser) -> None:
        other = cl.Context([den.queue.device])
        stranger = cl_array.Array(cl.CommandQueue(other), OUT, np.float32, data=cl.SVM(np.zeros(OUT, np.float32)))
        with pytest.raises(ArgumentError, match=r"out\): expected an Array in the context of .*, got one of another"):
            den.denoise(FRAME, out=stranger)

    def test_elements_beyond_its_end(self, den: Denoiser, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr(svm, "capabilities", lambda device: svm.SYSTEM)
        short = cl_array.Array(den.queue, SHAPE, np.float32, data=cl.SVM(np.zeros(5, np.float32)))
        with pytest.raises(FrameError, match=r"Frame\.depth: expected elements inside their buffer, got bytes 0 to"):
            den.denoise(replace(FRAME, depth=short))


def test_other_memory_is_taken_where_all_memory_is_shared(queue: cl.CommandQueue) -> None:
    class Device:
        svm_capabilities = svm.SYSTEM

    svm.check_svm("depth", of_other_memory(queue).base_data, Device())


def test_a_device_of_opencl_1_has_none() -> None:
    class Device:
        @property
        def svm_capabilities(self) -> int:
            raise cl.LogicError("clGetDeviceInfo failed: INVALID_VALUE")

    assert capabilities(Device()) == 0


def held_up(queue: cl.CommandQueue) -> cl.UserEvent:
    go = cl.UserEvent(queue.context)
    cl.enqueue_barrier(queue, wait_for=[go])
    return go


class Thing:
    """Something that can be watched."""


def test_memory_is_kept_while_it_is_used(queue: cl.CommandQueue) -> None:
    keeper, thing = InFlight(queue), Thing()
    watched, go = weakref.ref(thing), held_up(queue)
    keeper.keep([thing])
    del thing
    keeper.keep([])
    assert watched() is not None
    go.set_status(DONE)
    queue.finish()
    keeper.keep([])
    assert watched() is None


def test_a_keeper_does_not_go_before_the_memory_may(queue: cl.CommandQueue) -> None:
    keeper, thing = InFlight(queue), Thing()
    go = held_up(queue)
    ended: list[int] = []
    weakref.finalize(thing, lambda: ended.append(go.command_execution_status))
    keeper.keep([thing])
    del thing
    threading.Timer(0.1, go.set_status, [DONE]).start()
    del keeper
    assert ended == [DONE]


@pytest.mark.parametrize("closed", [False, True])
def test_a_frame_that_nobody_else_keeps_is_denoised(closed: bool, den: Denoiser, expected: np.ndarray) -> None:
    frame, go = in_svm(FRAME, of_numpy, den.queue), cl.UserEvent(den.queue.context)
    watched = weakref.ref(frame.color.base_data.mem)
    out = den.denoise(frame, wait_for=[go])
    del frame
    assert watched() is not None
    if closed:
        threading.Timer(0.1, go.set_status, [DONE]).start()
        den.close()
    else:
        go.set_status(DONE)
    assert_array_equal(out.get(), expected)
    if not closed:
        den.denoise(FRAME)
    assert watched() is None


def test_after_a_result_on_the_host_nothing_is_kept(den: Denoiser) -> None:
    frame = in_svm(FRAME, of_numpy, den.queue)
    watched = weakref.ref(frame.color.base_data.mem)
    den.denoise(frame, out=np.empty(OUT, np.float32))
    del frame
    assert watched() is None
