"""Device memory of a denoiser: what it holds at first, what is swapped, how much there is."""

from __future__ import annotations

import numpy as np
import pyopencl as cl
import pytest
from numpy.testing import assert_array_equal

from svgf_cl import DeviceError
from svgf_cl.device.buffers import Buffers
from svgf_cl.device.layout import Layout
from svgf_cl.device.memory_plan import memory_slots
from svgf_cl.filters.formats import stored
from svgf_cl.filters.pipeline import OUT, PREVIOUS, Inputs, history_pairs, pipeline
from svgf_cl.settings import Settings
from tests.faults import failing
from tests.frames import FULL, SHAPE, bumpy_sequence

INPUTS = Inputs.of(bumpy_sequence(FULL, count=1)[0])
LAYOUT = Layout(*SHAPE)
PASSES = pipeline(INPUTS, Settings(taa=True))
WRITTEN = {name for step in PASSES for name in step.writes} - {OUT}
SLOTS = memory_slots(PASSES, {name: stored(name, INPUTS, Settings()) for name in WRITTEN})


@pytest.fixture
def buffers(queue: cl.CommandQueue) -> Buffers:
    return Buffers(queue, LAYOUT, SLOTS)


def write(queue: cl.CommandQueue, buffer: cl.Buffer, value: float) -> None:
    cl.enqueue_fill_buffer(queue, buffer, np.float32(value), 0, buffer.size)


def test_history_begins_blank(buffers: Buffers) -> None:
    for pair in history_pairs(PASSES):
        for name in (pair, PREVIOUS + pair):
            assert_array_equal(buffers.read(name), np.float32(np.nan if "antialiased" in name else 0))
    assert_array_equal(buffers.read("history"), 0)


def test_nbytes_is_all_memory(buffers: Buffers) -> None:
    every = [*WRITTEN, *(PREVIOUS + name for name in history_pairs(PASSES))]
    assert buffers.nbytes == sum(b.size for b in {buffers[name].int_ptr: buffers[name] for name in every}.values())


def test_what_was_written_becomes_history(buffers: Buffers) -> None:
    guide, previous = buffers["guide"], buffers["previous guide"]
    buffers.begin_frame()
    assert (buffers["guide"], buffers["previous guide"]) == (previous, guide)


def test_a_guest_goes_where_its_memory_goes(buffers: Buffers) -> None:
    for _ in range(2):
        assert buffers["level 3"] is buffers["previous guide"]
        buffers.begin_frame()


def test_last_owner_of_shared_memory_survives(buffers: Buffers) -> None:
    assert buffers.survives("guide")
    assert buffers.survives("modulated")
    assert not buffers.survives("demodulated")


def test_a_copy_survives_the_next_owner(queue: cl.CommandQueue) -> None:
    buffers = Buffers(queue, LAYOUT, SLOTS, copies=True)
    for value, name in enumerate(("demodulated", "accumulated")):
        write(queue, buffers[name], value)
        buffers.copy_aside(name)
        assert buffers.survives(name)
    assert_array_equal(buffers.read("demodulated"), 0)
    assert_array_equal(buffers.read("accumulated"), 1)


def test_copies_count_as_memory(buffers: Buffers, queue: cl.CommandQueue) -> None:
    copies = sum(buffers[name].size for name in WRITTEN)
    assert Buffers(queue, LAYOUT, SLOTS, copies=True).nbytes == buffers.nbytes + copies


def test_too_large_an_image_is_refused_with_what_it_needs_and_what_there_is(queue: cl.CommandQueue) -> None:
    layout = Layout(1 << 18, 1 << 18)
    needed = sum(layout.nbytes(slot.planes.depth) for slot in SLOTS) / 2**20
    there = queue.device.global_mem_size / 2**20
    nothing_taken = failing("Buffer", 0, lambda *_: pytest.fail("expected no buffer to be made"))
    words = rf"no room for .* {needed:.1f} MiB needed in all; it has {there:.1f} MiB"
    with nothing_taken, pytest.raises(DeviceError, match=words):
        Buffers(queue, layout, SLOTS)
