"""When the device fails: what is said, and that the denoiser goes on, from the last frame or from the beginning."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Any

import numpy as np
import pyopencl as cl
import pyopencl.array as cl_array
import pytest
from numpy.testing import assert_array_equal

from svgf_cl import Denoiser, DeviceError, Inputs
from svgf_cl.device import programs, user_arrays
from svgf_cl.device.memory_plan import memory_slots
from svgf_cl.device.opencl_errors import allocate, check_room
from svgf_cl.filters import DEFAULT
from tests.faults import Call, broken_launch, failing, no_room
from tests.frames import FULL, PLAIN, SHAPE, bumpy_sequence

FRAMES = bumpy_sequence(FULL, count=2)

# Buffers of a first frame: planes; the frame's arrays and the result. And those of its stages, where they are kept.
PIPELINE = DEFAULT().pipeline(Inputs.of(FRAMES[0]))
SLOTS = memory_slots(PIPELINE)
PLANES = len(SLOTS)
BUFFERS = PLANES + len(FULL) + len(("normal", "depth", "motion", "out"))
STAGES = sum(not buffer.previous for slot in SLOTS for buffer in slot.buffers)
COPIES = len(FULL) + 3  # from host to device, before the result comes back


def beyond_the_end(copy: Call, queue: cl.CommandQueue, target: Any, source: Any, **options: Any) -> Any:
    """A copy of more than there is."""
    wrong = np.empty(1 << 20)
    return copy(queue, target, wrong, **options) if isinstance(target, cl.Buffer) else copy(queue, wrong, source)


@pytest.fixture
def den(queue: cl.CommandQueue) -> Denoiser:
    return Denoiser(SHAPE, queue=queue)


@pytest.fixture(scope="module")
def pictures() -> list[np.ndarray]:
    """Of `FRAMES`, when nothing fails."""
    return [*map(Denoiser(SHAPE).denoise, FRAMES)]


class TestNoRoom:
    def test_is_told_with_what_was_needed_and_what_there_is(self, queue: cl.CommandQueue) -> None:
        there, most = queue.device.global_mem_size / 2**20, queue.device.max_mem_alloc_size / 2**20
        words = (
            f"{queue.device.name} has no room for a buffer of 1048576.0 MiB, of 2097152.0 MiB needed in all; it has "
            f"{there:.1f} MiB, {most:.1f} MiB for one buffer"
        )
        with pytest.raises(DeviceError, match=re.escape(words)):
            allocate(queue, 1 << 40, 1 << 41)

    def test_is_found_before_anything_is_taken(self, queue: cl.CommandQueue) -> None:
        check_room(queue.device, queue.device.global_mem_size)
        with pytest.raises(DeviceError, match="no room"):
            check_room(queue.device, queue.device.global_mem_size + 1)

    def test_another_error_is_not_taken_for_it(self, queue: cl.CommandQueue) -> None:
        def without_host_memory(buffer: Call, context: cl.Context, flags: int, nbytes: int) -> Any:
            return buffer(context, flags | cl.mem_flags.USE_HOST_PTR, nbytes)

        with failing("Buffer", 0, without_host_memory), pytest.raises(cl.LogicError, match="INVALID_"):
            allocate(queue, 4, 4)

    @pytest.mark.parametrize("copied", [False, True])
    def test_for_any_buffer_leaves_no_trace(
        self, copied: bool, queue: cl.CommandQueue, pictures: list[np.ndarray], monkeypatch: pytest.MonkeyPatch
    ) -> None:
        """Of the planes, and of numpy arrays in place or, as on a GPU, copied."""
        if copied:
            monkeypatch.setattr(user_arrays, "shares_memory", lambda device: False)
        for at in range(BUFFERS):
            den = Denoiser(SHAPE, queue=queue)
            with no_room(at), pytest.raises(DeviceError, match="no room for a buffer"):
                den.denoise(FRAMES[0])
            assert den.nbytes == 0
            assert_array_equal(den.denoise(FRAMES[0]), pictures[0])
        with no_room(BUFFERS):
            Denoiser(SHAPE, queue=queue).denoise(FRAMES[0])

    def test_in_a_sequence_leaves_the_history(self, den: Denoiser, pictures: list[np.ndarray]) -> None:
        den.denoise(FRAMES[0])
        on_device = {name: cl_array.to_device(den.queue, value) for name, value in FRAMES[1].present().items()}
        with no_room(0), pytest.raises(DeviceError, match="no room"):
            den.denoise(replace(FRAMES[1], **on_device))
        assert_array_equal(den.denoise(FRAMES[1]), pictures[1])

    def test_for_copies_of_stages_leaves_no_trace(self, queue: cl.CommandQueue, pictures: list[np.ndarray]) -> None:
        den = Denoiser(SHAPE, queue=queue, keep_stages=True)
        for at in range(PLANES, PLANES + STAGES):
            with no_room(at), pytest.raises(DeviceError, match="no room for a buffer"):
                den.denoise(FRAMES[0])
        assert_array_equal(den.denoise(FRAMES[0]), pictures[0])


class TestBrokenOff:
    """A frame that was begun and not finished is no history, nor is what it wrote over."""

    def assert_begins_anew(self, den: Denoiser) -> None:
        assert den.stages == []
        assert den.profile() == {}
        assert_array_equal(den.denoise(FRAMES[1]), Denoiser(SHAPE).denoise(FRAMES[1]))

    @pytest.mark.parametrize("at", range(len(PIPELINE.passes)))
    def test_at_any_kernel(self, at: int, den: Denoiser) -> None:
        den.denoise(FRAMES[0])
        words = r"^denoise: expected .* to work, got clEnqueueNDRangeKernel failed: \w+; the history is discarded"
        with broken_launch(at), pytest.raises(DeviceError, match=words):
            den.denoise(FRAMES[1])
        self.assert_begins_anew(den)

    def test_when_the_result_is_fetched(self, den: Denoiser, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr(user_arrays, "shares_memory", lambda device: False)
        den.denoise(FRAMES[0])
        with (
            failing("enqueue_copy", COPIES, beyond_the_end),
            pytest.raises(DeviceError, match="the history is discarded"),
        ):
            den.denoise(FRAMES[1])
        self.assert_begins_anew(den)

    def test_by_the_user(self, den: Denoiser) -> None:
        def interrupt(*_: object) -> None:
            raise KeyboardInterrupt

        den.denoise(FRAMES[0])
        with failing("enqueue_nd_range_kernel", 4, interrupt), pytest.raises(KeyboardInterrupt):
            den.denoise(FRAMES[1])
        self.assert_begins_anew(den)


class TestNotBegun:
    def test_copying_a_field_fails(
        self, den: Denoiser, pictures: list[np.ndarray], monkeypatch: pytest.MonkeyPatch
    ) -> None:
        monkeypatch.setattr(user_arrays, "shares_memory", lambda device: False)
        den.denoise(FRAMES[0])
        with failing("enqueue_copy", 2, beyond_the_end), pytest.raises(DeviceError, match="the frame was not started"):
            den.denoise(FRAMES[1])
        assert_array_equal(den.denoise(FRAMES[1]), pictures[1])

    def test_a_kernel_does_not_build(
        self, den: Denoiser, pictures: list[np.ndarray], monkeypatch: pytest.MonkeyPatch
    ) -> None:
        with monkeypatch.context() as patch:
            patch.setattr(programs, "_build", programs._build.__wrapped__)
            patch.setattr(programs, "source", lambda stage: "#error no such kernel")
            with pytest.raises(DeviceError, match="does not build on this device"):
                den.denoise(bumpy_sequence(PLAIN, count=1)[0])
        assert_array_equal(den.denoise(FRAMES[0]), pictures[0])


def test_a_stage_that_cannot_be_read_may_be_tried_again(den: Denoiser) -> None:
    den.denoise(FRAMES[0])
    with (
        failing("enqueue_copy", 0, beyond_the_end),
        pytest.raises(DeviceError, match=r"^stage: expected .* got clEnq"),
    ):
        den.stage("depth")
    assert np.isfinite(den.stage("depth")).all()
