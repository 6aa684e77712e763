"""Device memory of a denoiser: what it holds at first and after a cut, what is swapped, how much there is."""

from __future__ import annotations

import numpy as np
import pyopencl as cl
import pytest
from numpy.testing import assert_array_equal

from svgf_cl import DeviceError, Inputs, Settings
from svgf_cl.device.buffers import Buffers
from svgf_cl.device.layout import Layout
from svgf_cl.device.memory import Memory
from svgf_cl.device.memory_plan import memory_slots
from svgf_cl.filters.pipeline import Buffer, Life
from svgf_cl.filters.temporal import UNKNOWN
from tests.faults import failing
from tests.frames import FULL, SHAPE, bumpy_sequence

INPUTS = Inputs.of(bumpy_sequence(FULL, count=1)[0])
LAYOUT = Layout(*SHAPE)
PIPELINE = Settings(taa=True).pipeline(INPUTS)
MEMORY = Memory(LAYOUT, memory_slots(PIPELINE))
RESOURCES = {resource.name: resource for resource in PIPELINE.resources}
LASTING = {resource.name: Buffer(resource, resource.life is Life.PAIR) for resource in PIPELINE.lasting}
EVERY = [*map(Buffer, PIPELINE.resources), *(buffer for buffer in LASTING.values() if buffer.previous)]


@pytest.fixture
def buffers(queue: cl.CommandQueue) -> Buffers:
    return Buffers(queue, MEMORY)


def now(name: str) -> Buffer:
    return Buffer(RESOURCES[name])


def before(name: str) -> Buffer:
    return Buffer(RESOURCES[name], previous=True)


def write(queue: cl.CommandQueue, buffer: cl.Buffer, value: float) -> None:
    cl.enqueue_fill_buffer(queue, buffer, np.float32(value), 0, buffer.size)


def test_all_is_zero_at_first(buffers: Buffers) -> None:
    for buffer in EVERY:
        assert_array_equal(buffers.read(buffer), 0)


def test_what_is_forgotten_says_so_and_the_rest_stays(buffers: Buffers, queue: cl.CommandQueue) -> None:
    """The antialiased picture is unknown; kernels go by the frame's number for the rest, as a cut shall cost little."""
    for buffer in EVERY:
        write(queue, buffers[buffer], 7)
    buffers.forget(PIPELINE.lasting)
    assert_array_equal(buffers.read(before("antialiased"))[: 3 * LAYOUT.plane], np.float32(UNKNOWN))
    for buffer in (before("guide"), LASTING["moments"], LASTING["level_1"], now("guide"), now("antialiased")):
        assert_array_equal(buffers.read(buffer), 7)


def test_another_inherits_what_was_written_last(buffers: Buffers, queue: cl.CommandQueue) -> None:
    heir = Buffers(queue, MEMORY)
    for value, resource in enumerate(PIPELINE.lasting, start=1):
        write(queue, buffers[Buffer(resource)], value)
    heir.inherit(buffers, PIPELINE.lasting)
    heir.begin_frame()
    for value, buffer in enumerate(LASTING.values(), start=1):
        assert_array_equal(heir.read(buffer)[: MEMORY.nbytes(buffer.resource) // 4], value)


def test_nbytes_is_all_memory(buffers: Buffers) -> None:
    assert buffers.nbytes == sum(b.size for b in {buffers[each].int_ptr: buffers[each] for each in EVERY}.values())


def test_what_was_written_becomes_history(buffers: Buffers) -> None:
    guide, previous = buffers[now("guide")], buffers[before("guide")]
    buffers.begin_frame()
    assert (buffers[now("guide")], buffers[before("guide")]) == (previous, guide)


def test_a_guest_goes_where_its_memory_goes(buffers: Buffers) -> None:
    for _ in range(2):
        assert buffers[now("level_3")] is buffers[before("guide")]
        buffers.begin_frame()


def test_last_owner_of_shared_memory_survives(buffers: Buffers) -> None:
    assert buffers.survives(now("guide"))
    assert buffers.survives(now("modulated"))
    assert not buffers.survives(now("demodulated"))


def test_a_copy_survives_the_next_owner(queue: cl.CommandQueue) -> None:
    buffers = Buffers(queue, MEMORY, copies=True)
    for value, name in enumerate(("demodulated", "accumulated")):
        write(queue, buffers[now(name)], value)
        buffers.copy_aside(now(name))
        assert buffers.survives(now(name))
    assert_array_equal(buffers.read(now("demodulated")), 0)
    assert_array_equal(buffers.read(now("accumulated")), 1)


def test_copies_count_as_memory(buffers: Buffers, queue: cl.CommandQueue) -> None:
    copies = sum(buffers[Buffer(resource)].size for resource in PIPELINE.resources)
    assert Buffers(queue, MEMORY, copies=True).nbytes == buffers.nbytes + copies


def test_too_large_an_image_is_refused_with_what_it_needs_and_what_there_is(queue: cl.CommandQueue) -> None:
    memory = Memory(Layout(1 << 18, 1 << 18), MEMORY.slots)
    needed = sum(memory.sizes) / 2**20
    there = queue.device.global_mem_size / 2**20
    nothing_taken = failing("Buffer", 0, lambda *_: pytest.fail("expected no buffer to be made"))
    words = rf"no room for .* {needed:.1f} MiB needed in all; it has {there:.1f} MiB"
    with nothing_taken, pytest.raises(DeviceError, match=words):
        Buffers(queue, memory)
