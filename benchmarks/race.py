"""Speed of several denoisers in one interleaved run, so that what disturbs the machine disturbs all alike."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from benchmarks.oidn import Filter
from svgf_cl import Denoiser
from svgf_cl.room import PERIOD, room_frames

WHOLE, DEVICE = "svgf_cl, whole call", "svgf_cl, device"


@dataclass(frozen=True)
class Spread:
    """Median, 10th and 90th percentile."""

    median: float
    low: float
    high: float

    @classmethod
    def of(cls, samples: Sequence[float]) -> Spread:
        """Condense samples."""
        low, median, high = np.percentile(samples, (10, 50, 90)).tolist()
        return cls(median, low, high)

    def __format__(self, spec: str) -> str:
        """All three figures in the format of one: ``median (low-high)``."""
        return f"{self.median:{spec}} ({self.low:{spec}}-{self.high:{spec}})"


def race(
    den: Denoiser, filters: Mapping[str, Filter], rounds: int, advance: Callable[[], None]
) -> dict[str, list[float]]:
    """Let every denoiser filter the same frame of the built-in room, one after the other, round after round.

    Parameters
    ----------
    den : Denoiser
        Its shape is that of the frames.
    filters : mapping from name to Filter
        Of the same shape.
    rounds : int, >= 1
    advance : callable
        Called after each round, for a progress bar.

    Returns
    -------
    dict of list of float
        Milliseconds of each round by name: `WHOLE`, a call of `Denoiser.denoise` from numpy arrays into one, with its
        copies; `DEVICE`, the sum of that call's passes from OpenCL events; each filter, OIDN's execution alone.
    """
    inputs = list(room_frames(den.shape, PERIOD))
    out = np.empty((*den.shape, 3), np.float32)
    for frame in inputs:  # kernels are built, memory is touched, history is long enough
        den.denoise(frame, out=out)
    times: dict[str, list[float]] = {name: [] for name in (WHOLE, DEVICE, *filters)}
    for index in range(rounds):
        frame = inputs[index % PERIOD]
        begin = time.perf_counter()
        den.denoise(frame, out=out)
        times[WHOLE].append(1e3 * (time.perf_counter() - begin))
        times[DEVICE].append(sum(den.profile().values()))
        for name, rival in filters.items():
            rival.load(frame)
            begin = time.perf_counter()
            rival.execute()
            times[name].append(1e3 * (time.perf_counter() - begin))
            rival.check()
        advance()
    return times


def ratio(slow: Sequence[float], fast: Sequence[float]) -> Spread:
    """How many times faster one denoiser was than the other in the same round."""
    return Spread.of(np.divide(slow, fast).tolist())
