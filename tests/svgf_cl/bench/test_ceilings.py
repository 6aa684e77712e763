"""The ceilings' kernels do the work they are credited with."""

from __future__ import annotations

import numpy as np
import pyopencl as cl
import pytest

from svgf_cl.bench.ceilings import ALIGNED, CHAINS, OFFSET, CeilingBench, Ceilings
from svgf_cl.device.tuning import Tuning


@pytest.fixture(params=[1, 4, 8, 16])
def bench(request: pytest.FixtureRequest, queue: cl.CommandQueue, monkeypatch: pytest.MonkeyPatch) -> CeilingBench:
    """The kernels of every vector width; 1 copies as a GPU does."""
    tuning = Tuning(vector_width=request.param, work_group=(1, 1))
    monkeypatch.setattr("svgf_cl.bench.ceilings.best_tuning", lambda _: tuning)
    monkeypatch.setattr("svgf_cl.bench.ceilings.WORKING_SETS", (2**16, 2**17))
    monkeypatch.setattr("svgf_cl.bench.ceilings.COPIED", 2**18)
    monkeypatch.setattr("svgf_cl.bench.ceilings.COMPUTED", 1e-4)
    monkeypatch.setattr("svgf_cl.bench.ceilings.GPU_ITEMS", 256)
    return CeilingBench(queue)


def test_a_copy_reaches_every_byte(bench: CeilingBench, queue: cl.CommandQueue) -> None:
    assert len(bench.working_sets) == 2
    for size in bench.working_sets:
        half = size // 8  # floats
        numbers = np.arange(half + 1, dtype=np.float32)
        cl.enqueue_copy(queue, bench.source, numbers[:half])
        cl.enqueue_fill_buffer(queue, bench.target, np.float32(-1), 0, bench.target.size)
        assert bench.copy(size) > 0
        copied = np.empty(bench.target.size // 4, np.float32)
        cl.enqueue_copy(queue, copied, bench.target)
        np.testing.assert_array_equal(copied[:half], numbers[:half])
        assert (copied[half:] == -1).all()


def test_multiply_adds_are_computed(bench: CeilingBench, queue: cl.CommandQueue) -> None:
    """Each sum halves and adds 1, and so goes to 2."""
    assert bench.multiply() > 0
    first = np.empty(1, np.float32)
    cl.enqueue_copy(queue, first, bench.target)
    assert first[0] == pytest.approx(2 * CHAINS)
    assert bench.operations % (2 * CHAINS) == 0


@pytest.mark.parametrize("offset", [ALIGNED, OFFSET])
def test_loads_are_from_where_they_are_said_to_be(bench: CeilingBench, queue: cl.CommandQueue, offset: int) -> None:
    """All that is loaded is added up; the first float is left out by loads that begin beside it."""
    marked = np.ones(bench.source.size // 4, np.float32)
    marked[0] = 3
    cl.enqueue_copy(queue, bench.source, marked)
    bench.count = 16
    assert bench.load(offset) > 0
    first = np.empty(1, np.float32)
    cl.enqueue_copy(queue, first, bench.target)
    assert first[0] == 16 * CHAINS + (2 if offset == ALIGNED else 0)


def test_bandwidth_lies_between_the_measured_ones() -> None:
    ceilings = Ceilings([(2**10, 80.0), (2**20, 20.0)], 1.0, 1.0, 1.0)
    assert ceilings.bandwidth_at(2**15) == pytest.approx(50)
    assert ceilings.bandwidth_at(1) == 80
    assert ceilings.bandwidth_at(2**40) == 20
