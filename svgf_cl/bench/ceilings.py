"""Measures a device's limits: how fast it copies memory, loads from its nearest cache, and multiplies and adds."""

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

# Bytes of source and target together: from the size of a core's own cache to far beyond every cache.
WORKING_SETS = tuple(2**power for power in range(16, 30))
COPIED = 2**28  # bytes read and written per sample, at least: then the launch takes a negligible time
CHAINS = 12  # sums in flight: a core has two units, each of which returns a result every cycle, four cycles later
# Work-items for each compute unit: enough to fill a GPU's units, and to share a CPU's work evenly.
GPU_ITEMS, CPU_ITEMS = 2048, 8
COMPUTED = 4e-3  # seconds that a sample of loads or multiply-adds takes
TRIES = 9  # to find the number of rounds for that; the first tries are slow
ALIGNED, OFFSET = 0, 1  # distance in floats between the begin of a load and that of a vector
SAMPLES = 3  # of each kind, in each call of `sample`


@dataclass(frozen=True)
class Ceilings:
    """A device's limits.

    Parameters
    ----------
    bandwidth : sequence of (int, float), bytes and bytes / s
        Working set (source and target), and the highest speed of a copy: bytes read plus bytes written.
    aligned_loads, offset_loads : float, bytes / s
        Speed of loads from the nearest cache, in aligned vectors, and in vectors that begin one float later.
    flops : float, 1 / s
        Single precision operations; a multiply-add counts as two.
    """

    bandwidth: Sequence[tuple[int, float]]
    aligned_loads: float
    offset_loads: float
    flops: float

    def bandwidth_at(self, working_set: float) -> float:
        """Return bytes per second for a working set in bytes, interpolated over its logarithm."""
        sizes, speeds = zip(*self.bandwidth, strict=True)
        return float(np.interp(np.log(working_set), np.log(sizes), speeds))


class CeilingBench:
    """The kernels that measure the limits of one device; they are sampled during the same run as the filter's passes.

    Parameters
    ----------
    queue : pyopencl.CommandQueue
        With profiling.

    Attributes
    ----------
    count : int
        Rounds of `load` and `multiply`: enough for a sample of about `COMPUTED` seconds.
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
            warnings.simplefilter("ignore", cl.CompilerWarning)  # drivers write to their log even on success
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
        """Return the mean seconds to read and write each byte of a working set (one of `working_sets`) once."""
        repeats = max(1, COPIED // working_set)
        count = working_set // (8 * self._width * self._items)
        first, step = (1, self._items) if self._on_gpu else (count, 1)
        scalars = [np.int32(value) for value in (first, step, count, repeats)]
        return self._seconds(self._copy, *scalars, self.source, self.target) / repeats

    def load(self, offset: int) -> float:
        """Return the seconds to load `loaded` bytes; `offset` is `ALIGNED` or `OFFSET`."""
        return self._seconds(self._load, np.int32(self.count), np.int32(offset), self.source, self.target)

    def multiply(self) -> float:
        """Return the seconds for `operations` floating-point operations."""
        return self._seconds(self._multiply, np.int32(self.count), np.float32(0.5), np.float32(1), self.target)

    @property
    def operations(self) -> int:
        """Number of operations that `multiply` computes."""
        return 2 * CHAINS * self._width * self._items * self.count

    @property
    def loaded(self) -> int:
        """Number of bytes that `load` loads."""
        return 4 * CHAINS * self._width * self._items * self.count

    def _whole(self, working_set: int) -> int:
        """Return the largest working set up to this one that gives every work-item the same number of vectors."""
        unit = 8 * self._width * self._items
        return working_set // unit * unit

    def _seconds(self, kernel: cl.Kernel, *arguments: Any) -> float:
        event = kernel(self._queue, (self._items,), (self._group,), *arguments)
        event.wait()
        return 1e-9 * float(event.profile.end - event.profile.start)


class CeilingSamples:
    """The samples of one device's limits.

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
        """Take a few samples of each kind."""
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
        """Yield each benchmark's name, its samples in s, and the bytes or operations of a sample."""
        for size, seconds in self._copies.items():
            yield f"ceiling.copy.{size}", seconds, {"bytes": size}
        for offset, seconds in self._loads.items():
            yield f"ceiling.load.{offset}", seconds, {"bytes": self._bench.loaded}
        yield "ceiling.multiply", self._multiplications, {"flops": self._bench.operations}
