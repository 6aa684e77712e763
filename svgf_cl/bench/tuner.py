"""Finds a device's fastest tuning: races candidates against the default on frames of the built-in room.

Coordinate descent, one race each for vector width, exponential, alignment of rows and work-group. In a race all denoise
the same frames in turn, a few rounds at a time, and the slower half drops out. What counts is a candidate's time over
the default's in the same round: whatever else the machine is doing hits both alike.

That is time on the device. Where numpy arrays are copied to the device, a last race is about the copies alone, and what
counts there is the whole time of a call from numpy to numpy.
"""

from __future__ import annotations

import random
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, field, replace
from statistics import median
from typing import Any

import numpy as np
import pyopencl as cl

from svgf_cl.denoiser import Denoiser
from svgf_cl.device.apart import summary
from svgf_cl.device.layout import Layout
from svgf_cl.device.tuning import EXPONENTIALS, VECTOR_WIDTHS, Tuning, default_tuning
from svgf_cl.device.user_arrays import shares_memory
from svgf_cl.errors import SvgfError
from svgf_cl.frame import Frame, Shape
from svgf_cl.io.synthetic import PERIOD, room_frames
from svgf_cl.oracle.rounding import relative_error

# In this order. Work-groups come last, as PoCL compiles all kernels anew for each: 2 s. None has more than 256 items:
# GPUs run these whatever registers a kernel takes.
CHOICES: dict[str, tuple[Any, ...]] = {
    "vector_width": VECTOR_WIDTHS,
    "exponential": EXPONENTIALS,
    "row_alignment": (16, 64, 128, 256),
    "work_group": ((8, 1), (16, 1), (32, 1), (64, 1), (128, 1), (8, 8), (16, 4), (32, 4), (64, 4), (16, 16)),
}
# Elsewhere than on a CPU. Vectors of 8 and 16 pixels need more registers than a work-item of a GPU has, and groups are
# whole warps of any vendor: 64 items, or multiples of that.
GPU_CHOICES: dict[str, tuple[Any, ...]] = CHOICES | {
    "vector_width": (1, 4),
    "work_group": ((64, 1), (128, 1), (256, 1), (8, 8), (16, 4), (32, 2), (16, 8), (32, 4), (64, 4), (32, 8), (16, 16)),
}

SECONDS = 45.0  # then no candidate is built any more and no round begun, but for the least that a verdict takes
FINAL_SHARE = 0.15  # of these

WARM_UP = 3  # frames: kernels are built, memory is touched
HOPELESS = 2.5  # times the default's time in the warm-up: out without a race
ROUNDS = 4  # until the slower half drops out
FINAL_ROUNDS = 12, 40  # at least, and while there is time

# The winner must be faster in so many rounds of the final (of 12, chance does that once in 50 searches), and worth it.
CERTAIN = 0.8
WORTHWHILE = 0.98  # of the default's time
# Interquartile range of the default's time over its median, up to which a verdict is worth keeping. Over 40 rounds that
# waver so much the median ratio has a standard error of 2 %: as much as the least gain that counts. On two quiet cores
# 4 to 7 % were seen, with another program on each 12 %.
STEADY = 0.1

# Tunings differ by rounding, and by more where rounding decides about a tap; a column of wrong pixels is beyond both.
ROUNDING = 1e-4  # relative, as in svgf_cl.oracle.rounding
DECIDED_OTHERWISE = 5e-4  # of the pixels


@dataclass
class Trial:
    """A tuning and how it did.

    Parameters
    ----------
    tuning : Tuning
    times : list of float, ms
        Time of each frame on the device.
    ratios : list of float
        These times over the default's for the same frame.
    fault : str
        Why it is out of the question; empty for a sound one.
    """

    tuning: Tuning
    times: list[float] = field(default_factory=list)
    ratios: list[float] = field(default_factory=list)
    fault: str = ""

    @property
    def time(self) -> float:
        """Median time of a frame, in ms."""
        return median(self.times)

    @property
    def ratio(self) -> float:
        """Median time over the default's; infinite for one that never raced."""
        return median(self.ratios) if self.ratios else float("inf")

    @property
    def wavering(self) -> float:
        """Interquartile range of its times over their median; 0 for one that never raced."""
        if not self.times:
            return 0.0
        lower, upper = np.percentile(self.times, (25, 75))
        return float(upper - lower) / self.time

    @property
    def is_faster(self) -> bool:
        """Whether it beats the default beyond noise."""
        wins = sum(ratio < 1 for ratio in self.ratios)
        return self.ratio <= WORTHWHILE and wins >= CERTAIN * len(self.ratios)

    def as_json(self) -> dict[str, Any]:
        """What is known of it, for a file; None for what was not timed."""
        timed = {"ms": self.time, "ratio": self.ratio} if self.times else {"ms": None, "ratio": None}
        return {"tuning": str(self.tuning), "values": asdict(self.tuning), **timed, "fault": self.fault}


@dataclass
class Runner:
    """A trial on its way, with the denoiser that is timed."""

    trial: Trial
    denoiser: Denoiser
    warm_up: float  # ms, of a frame


class Tuner:
    """A search for the fastest tuning of one device.

    Parameters
    ----------
    shape : (int, int)
        (height, width) of the frames to tune for, >= 1.
    queue : pyopencl.CommandQueue
        In order, with profiling.
    seconds : float
        For the search; the least that a verdict takes may take longer.

    Attributes
    ----------
    trials : list of Trial
        Every tuning tried, in order; the default first.
    untried : int
        Candidates for which there was no time.
    reference : Trial
        The default as it did in the final, or in all races where there was none.
    """

    def __init__(self, shape: Shape, queue: cl.CommandQueue, seconds: float = SECONDS) -> None:
        self._shape = shape
        self._seconds = seconds
        self._queue = queue
        self._frames = list(room_frames(shape, PERIOD))
        self._out = np.empty((*shape, 3), np.float32)
        self._expected: np.ndarray | None = None
        self._random = random.Random(0)
        self._choices = CHOICES if queue.device.type & cl.device_type.CPU else GPU_CHOICES
        self._default = Trial(default_tuning(queue.device))
        self.trials = [self._default]
        self.untried = 0
        self.reference = self._default

    @property
    def steps(self) -> int:
        """Of a search, as its progress is counted."""
        return sum(map(len, self._choices.values())) + 1

    def race_copies(self, tuning: Tuning) -> Trial | None:
        """Race copies by way of pinned memory against direct ones, after `search`.

        Parameters
        ----------
        tuning : Tuning
            The one to use, with direct copies.

        Returns
        -------
        Trial, optional
            `tuning` with pinned copies; to be used if it `is_faster`. None where the device works in the host's memory,
            so that hardly anything is copied.
        """
        if shares_memory(self._queue.device):
            return None
        direct, pinned = Trial(tuning), Trial(replace(tuning, pinned_copies=True))
        runners = [self._enter(direct), self._enter(pinned)]
        self._run(runners, FINAL_ROUNDS, time.monotonic() + FINAL_SHARE * self._seconds, self._milliseconds_of_call)
        return pinned

    def search(self, advance: Callable[[], None] = lambda: None) -> Trial:
        """Race the candidates, then the best of them against the default alone.

        Parameters
        ----------
        advance : callable
            Called `steps` times, for a progress bar.

        Returns
        -------
        Trial
            That final; the tuning to use is its own if it `is_faster`, else the default.

        Raises
        ------
        SvgfError
            If the default itself does not run on the device.
        """
        begin = time.monotonic()
        best = self._default
        for knob in self._choices:
            best = self._race(best, knob, begin + (1 - FINAL_SHARE) * self._seconds, advance)
        final = Trial(best.tuning)
        if best is not self._default:
            self.reference = Trial(self._default.tuning)
            self._run([self._enter(self.reference), self._enter(final)], FINAL_ROUNDS, begin + self._seconds)
        advance()
        return final

    @property
    def doubts(self) -> list[str]:
        """Why what was found should not be kept; empty where it should."""
        found = []
        if self.untried:
            found.append(f"no time was left for {self.untried} candidates")
        if self.reference.wavering > STEADY:
            found.append(f"the default's own time wavers by {self.reference.wavering:.0%}, more than {STEADY:.0%}")
        return found

    def _race(self, best: Trial, knob: str, deadline: float, advance: Callable[[], None]) -> Trial:
        """The fastest of `best`, the default, and what comes of giving `best` other values of one knob."""
        default = self._enter(self._default)
        rivals = [] if best is self._default else [self._enter(best)]
        for value in self._choices[knob]:
            rivals += self._candidate(replace(best.tuning, **{knob: value}), deadline)
            advance()
        rivals = [runner for runner in rivals if runner.warm_up <= HOPELESS * default.warm_up]
        while rivals:
            self._run([default, *rivals], (1, ROUNDS), deadline)
            rivals.sort(key=lambda runner: runner.trial.ratio)
            if len(rivals) == 1:
                break
            del rivals[(len(rivals) + 1) // 2 :]
        return min([self._default, *(runner.trial for runner in rivals)], key=lambda trial: trial.ratio)

    def _candidate(self, tuning: Tuning, deadline: float) -> list[Runner]:
        """A runner for a tuning, or none if it was tried, is at fault, or comes too late."""
        if self._launch(tuning) in {self._launch(trial.tuning) for trial in self.trials}:
            return []
        if time.monotonic() > deadline:
            self.untried += 1
            return []
        trial = Trial(tuning)
        self.trials.append(trial)
        try:
            tuning.check(self._queue.device)
            return [self._enter(trial)]
        except (SvgfError, cl.Error) as error:
            trial.fault = summary(str(error))
            return []

    def _launch(self, tuning: Tuning) -> tuple[Any, ...]:
        """What a tuning comes to at this size."""
        return *tuning.defines.values(), tuning.work_group, Layout(*self._shape, tuning.row_alignment).pitch

    def _enter(self, trial: Trial) -> Runner:
        """Warm up; `SvgfError` if the result is not the default's."""
        denoiser = Denoiser(self._shape, queue=self._queue, tuning=trial.tuning)
        times = [self._milliseconds(denoiser, frame) for frame in self._frames[:WARM_UP]]
        if self._expected is None:
            self._expected = self._out.copy()
        off = np.mean(~(relative_error(self._out, self._expected) <= ROUNDING))
        if off > DECIDED_OTHERWISE:
            raise SvgfError(f"{off:.2%} of its pixels differ from the default's")
        return Runner(trial, denoiser, min(times[1:]))

    def _run(
        self,
        runners: Sequence[Runner],
        rounds: tuple[int, int],
        deadline: float,
        clock: Callable[[Denoiser, Frame], float] | None = None,
    ) -> None:
        """Time runners against the first, frame by frame in turn: rounds[1] frames, after rounds[0] only in time.

        `clock` times a frame, in ms; without one its time on the device counts.
        """
        clock = clock or self._milliseconds
        for index in range(rounds[1]):
            if index >= rounds[0] and time.monotonic() > deadline:
                break
            frame = self._frames[(WARM_UP + index) % PERIOD]
            times = {}
            for runner in self._random.sample(runners, len(runners)):
                times[runner.trial.tuning] = clock(runner.denoiser, frame)
            for runner in runners:
                runner.trial.times.append(times[runner.trial.tuning])
                runner.trial.ratios.append(times[runner.trial.tuning] / times[runners[0].trial.tuning])

    def _milliseconds(self, denoiser: Denoiser, frame: Frame) -> float:
        """Time of a frame on the device."""
        denoiser.denoise(frame, out=self._out)
        return sum(denoiser.profile().values())

    def _milliseconds_of_call(self, denoiser: Denoiser, frame: Frame) -> float:
        """Time of a call from numpy arrays to a numpy array, as its caller sees it."""
        begin = time.perf_counter()
        denoiser.denoise(frame, out=self._out)
        return 1e3 * (time.perf_counter() - begin)
