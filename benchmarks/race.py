"""Times several denoisers in turns, so that other work on the machine affects all of them alike."""

from __future__ import annotations

import time
from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from svgf_cl import Denoiser
from svgf_cl.bench.results import Result
from svgf_cl.bench.rig import EVENT, HOST
from svgf_cl.compare.oidn import OidnFilter
from svgf_cl.frame import Shape, extent
from svgf_cl.io.synthetic import PERIOD, room_frames

# Seconds of each round, by denoiser and clock.
Times = Mapping[tuple[str, str], Sequence[float]]


@dataclass(frozen=True)
class Spread:
    """Median, 10th and 90th percentile."""

    median: float
    low: float
    high: float

    @classmethod
    def of(cls, samples: Sequence[float]) -> Spread:
        """Summarise samples."""
        low, median, high = np.percentile(samples, (10, 50, 90)).tolist()
        return cls(median, low, high)

    def __format__(self, spec: str) -> str:
        """All three figures with this format: ``median (low-high)``."""
        return f"{self.median:{spec}} ({self.low:{spec}}-{self.high:{spec}})"


def race(
    denoisers: Mapping[str, Denoiser], filters: Mapping[str, OidnFilter], rounds: int, advance: Callable[[], None]
) -> Times:
    """Let all denoisers filter the same frame of the built-in room in turns, for several rounds.

    Parameters
    ----------
    denoisers : mapping from name to Denoiser
        All for the shape of the frames.
    filters : mapping from name to OidnFilter
        For the same shape.
    rounds : int, >= 1
    advance : callable
        Called after each round, for a progress bar.

    Returns
    -------
    mapping from (name, clock) to list of float, s
        `HOST`: a call of `Denoiser.denoise` from numpy arrays to a numpy array, with its copies, or OIDN's execution
        alone; `EVENT`: the sum of that call's passes, from OpenCL events.
    """
    (shape,) = {den.shape for den in denoisers.values()}
    inputs = list(room_frames(shape, PERIOD))
    out = np.empty((*shape, 3), np.float32)
    for den in denoisers.values():
        for frame in inputs:  # builds kernels, touches memory, fills the history
            den.denoise(frame, out=out)
    times: dict[tuple[str, str], list[float]] = defaultdict(list)
    for index in range(rounds):
        frame = inputs[index % PERIOD]
        for name, den in denoisers.items():
            begin = time.perf_counter()
            den.denoise(frame, out=out)
            times[name, HOST].append(time.perf_counter() - begin)
            times[name, EVENT].append(1e-3 * sum(den.profile().values()))
        for name, rival in filters.items():
            rival.load(frame)
            begin = time.perf_counter()
            rival.execute()
            times[name, HOST].append(time.perf_counter() - begin)
            rival.check()
        advance()
    return times


def ratio(slow: Sequence[float], fast: Sequence[float]) -> Spread:
    """How many times as long the slow one took as the fast one in the same round."""
    return Spread.of(np.divide(slow, fast).tolist())


def results(times: Times, device: str, shape: Shape) -> Iterator[Result]:
    """The times as a benchmark's results.

    `device` is the selector of svgf_cl's device, `shape` the size of the frames.
    """
    for (name, clock), seconds in times.items():
        words = ".".join(("race", *name.lower().split(), extent(shape)))
        facts = {"race": name, "width": shape[1], "height": shape[0]}
        yield Result(words, device, clock, tuple(seconds), facts)
