"""What a device can do at best: copy memory, by size; load from its nearest cache; multiply and add."""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from importlib import resources
from typing import Any

import numpy as np
import pyopencl as cl

from svgf_cl.device.programs import OPTIONS
from svgf_cl.device.tuning import best_tuning

# Source and target together: from a core's own cache to far out of every cache.
WORKING_SETS = tuple(2**power for power in range(16, 30))
COPIED = 2**28  # bytes read and written per sample, at least: launching is nothing beside it
CHAINS = 12  # sums in flight: a core has two units, each with a result every cycle after four
# Work-items of a compute unit: enough to keep a GPU's units full, and to share a CPU's work evenly.
GPU_ITEMS, CPU_ITEMS = 2048, 8
COMPUTED = 4e-3  # seconds of a sample of loads or multiply-adds
TRIES = 9  # to find out how many those are; the first ones are slow
ALIGNED, OFFSET = 0, 1  # floats that a load begins off where vectors do
SAMPLES = 3  # of each, every time


@dataclass(frozen=True)
class Ceilings:
    """A device's limits.

    Parameters
    ----------
    bandwidth : sequence of (int, float), bytes and bytes / s
        Working set (source and target) and how fast it is copied at best: bytes read plus bytes written.
    aligned_loads, offset_loads : float, bytes / s
        Loaded from the nearest cache in vectors that begin where a vector does, and one float beside.
    flops : float, 1 / s
        Single precision operations, a multiply-add counted as two.
    """

    bandwidth: Sequence[tuple[int, float]]
    aligned_loads: float
    offset_loads: float
    flops: float

    def bandwidth_at(self, working_set: float) -> float:
        """Bytes per second for a working set in bytes, interpolated over its logarithm."""
        sizes, speeds = zip(*self.bandwidth, strict=True)
        return float(np.interp(np.log(working_set), np.log(sizes), speeds))


class CeilingBench:
    """The ceilings' kernels on one device, to be sampled beside what they bound.

    Parameters
    ----------
    queue : pyopencl.CommandQueue
        With profiling.

    Attributes
    ----------
    count : int
        Rounds of `load` and `multiply`: so many that a sample takes long enough.
    """

    def __init__(self, queue: cl.CommandQueue) -> None:
        self._queue = queue
        device = queue.device
        self._width = best_tuning(device).vector_width
        self._on_gpu = self._width == 1
        self._group = 256 if self._on_gpu else 1
        self._items = device.max_compute_units * (GPU_ITEMS if self._on_gpu else CPU_ITEMS)
        source = (resources.files("svgf_cl.bench") / "ceilings.cl").read_text(encoding="utf-8")
        program = cl.Program(queue.context, source)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", cl.CompilerWarning)  # drivers report success in their log
            program.build([*OPTIONS, f"-DVW={self._width}", f"-DCHAINS={CHAINS}"])
        self._copy, self._load, self._multiply = (cl.Kernel(program, name) for name in ("copy", "load", "multiply"))
        room = min(max(WORKING_SETS) // 2, device.max_mem_alloc_size)
        self.source, self.target = (cl.Buffer(queue.context, cl.mem_flags.READ_WRITE, room) for _ in range(2))
        for buffer in (self.source, self.target):
            cl.enqueue_fill_buffer(queue, buffer, np.float32(1), 0, room)
        self.working_sets = [size for size in map(self._whole, WORKING_SETS) if 0 < size <= 2 * room]
        self.count = 1000
        fastest = min(self.multiply() for _ in range(TRIES))
        self.count = max(1, round(self.count * COMPUTED / fastest))

    def copy(self, working_set: int) -> float:
        """Seconds to read and write each byte of a working set (one of `working_sets`) once, on average."""
        repeats = max(1, COPIED // working_set)
        count = working_set // (8 * self._width * self._items)
        first, step = (1, self._items) if self._on_gpu else (count, 1)
        scalars = [np.int32(value) for value in (first, step, count, repeats)]
        return self._seconds(self._copy, *scalars, self.source, self.target) / repeats

    def load(self, offset: int) -> float:
        """Seconds to load `loaded` bytes; `ALIGNED`, or `OFFSET` from where vectors begin."""
        return self._seconds(self._load, np.int32(self.count), np.int32(offset), self.source, self.target)

    def multiply(self) -> float:
        """Seconds for `operations` floating-point operations."""
        return self._seconds(self._multiply, np.int32(self.count), np.float32(0.5), np.float32(1), self.target)

    @property
    def operations(self) -> int:
        """What `multiply` computes."""
        return 2 * CHAINS * self._width * self._items * self.count

    @property
    def loaded(self) -> int:
        """What `load` loads."""
        return 4 * CHAINS * self._width * self._items * self.count

    def _whole(self, working_set: int) -> int:
        """The largest working set up to this one that is the same number of vectors for every work-item."""
        unit = 8 * self._width * self._items
        return working_set // unit * unit

    def _seconds(self, kernel: cl.Kernel, *arguments: Any) -> float:
        event = kernel(self._queue, (self._items,), (self._group,), *arguments)
        event.wait()
        return 1e-9 * float(event.profile.end - event.profile.start)


class CeilingSamples:
    """What was sampled of one device's ceilings.

    Parameters
    ----------
    queue : pyopencl.CommandQueue
        With profiling.
    """

    def __init__(self, queue: cl.CommandQueue) -> None:
        self._bench = CeilingBench(queue)
        self._copies: dict[int, list[float]] = {size: [] for size in self._bench.working_sets}
        self._loads: dict[int, list[float]] = {ALIGNED: [], OFFSET: []}
        self._multiplications: list[float] = []

    def sample(self) -> None:
        """Take a few samples of each."""
        for _ in range(SAMPLES):
            for size, samples in self._copies.items():
                samples.append(self._bench.copy(size))
            for offset, samples in self._loads.items():
                samples.append(self._bench.load(offset))
            self._multiplications.append(self._bench.multiply())

    @property
    def ceilings(self) -> Ceilings:
        """The limits, by the fastest samples."""
        return Ceilings(
            bandwidth=[(size, size / min(samples)) for size, samples in self._copies.items()],
            aligned_loads=self._bench.loaded / min(self._loads[ALIGNED]),
            offset_loads=self._bench.loaded / min(self._loads[OFFSET]),
            flops=self._bench.operations / min(self._multiplications),
        )

    def named(self) -> Iterator[tuple[str, list[float], dict[str, int]]]:
        """Each benchmark's name, its samples in s, and what a sample moves or computes."""
        for size, seconds in self._copies.items():
            yield f"ceiling.copy.{size}", seconds, {"bytes": size}
        for offset, seconds in self._loads.items():
            yield f"ceiling.load.{offset}", seconds, {"bytes": self._bench.loaded}
        yield "ceiling.multiply", self._multiplications, {"flops": self._bench.operations}
