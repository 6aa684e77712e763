"""Finds a device's fastest tuning: races candidates against the default on frames of the built-in room.

The search is a coordinate descent: one race each for vector width, exponential, row alignment and work-group. In a race
all candidates denoise the same frames in turn, for a few rounds, and then the slower half drops out. A candidate is
judged by its time over the default's time in the same round, because other load on the machine slows both alike.

These are times on the device. If numpy arrays are copied to the device, a last race compares only the ways to copy
them, by the whole time of a call from numpy to numpy.
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

# In the order of the races. Work-groups come last, because PoCL compiles all kernels again for each: 2 s. None has more
# than 256 items: GPUs can run these, however many registers a kernel uses.
CHOICES: dict[str, tuple[Any, ...]] = {
    "vector_width": VECTOR_WIDTHS,
    "exponential": EXPONENTIALS,
    "row_alignment": (16, 64, 128, 256),
    "work_group": ((8, 1), (16, 1), (32, 1), (64, 1), (128, 1), (8, 8), (16, 4), (32, 4), (64, 4), (16, 16)),
}
# For devices that are not CPUs. Vectors of 8 and 16 pixels need more registers than a work-item of a GPU has. Groups
# are whole warps of any vendor: 64 items, or multiples of that.
GPU_CHOICES: dict[str, tuple[Any, ...]] = CHOICES | {
    "vector_width": (1, 4),
    "work_group": ((64, 1), (128, 1), (256, 1), (8, 8), (16, 4), (32, 2), (16, 8), (32, 4), (64, 4), (32, 8), (16, 16)),
}

SECONDS = 45.0  # after this time no candidate is built, and only the rounds that a result needs at least are run
FINAL_SHARE = 0.15  # of these seconds

WARM_UP = 3  # frames; then kernels are built and memory is in use
HOPELESS = 2.5  # a candidate that takes this many times as long as the default in the warm-up does not race
ROUNDS = 4  # until the slower half drops out
FINAL_ROUNDS = 12, 40  # at least, and at most if there is time

# The winner must be faster in this share of the final's rounds; by chance that happens in 1 of 50 searches (12 rounds).
CERTAIN = 0.8
WORTHWHILE = 0.98  # of the default's time, at most
# Interquartile range of the default's time over its median, at most, for a result that is worth storing. With more, the
# median ratio of 40 rounds has a standard error of 2 %, as much as the least gain that counts. It was 4 to 7 % on two
# quiet cores, and 12 % with another program on each core.
STEADY = 0.1

# Tunings differ by rounding, and by more where rounding decides about a tap; a column of wrong pixels exceeds both.
ROUNDING = 1e-4  # relative, as in svgf_cl.oracle.rounding
DECIDED_OTHERWISE = 5e-4  # of the pixels


@dataclass
class Trial:
    """A tuning and its results.

    Parameters
    ----------
    tuning : Tuning
    times : list of float, ms
        Time of each frame on the device.
    ratios : list of float
        These times over the default's for the same frame.
    fault : str
        Why it cannot be used; empty if it can.
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
        """Median of `ratios`; infinite for a trial that never raced."""
        return median(self.ratios) if self.ratios else float("inf")

    @property
    def wavering(self) -> float:
        """Interquartile range of its times over their median; 0 for a trial that never raced."""
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
        """Return the trial for a file; times are None if it was not timed."""
        timed = {"ms": self.time, "ratio": self.ratio} if self.times else {"ms": None, "ratio": None}
        return {"tuning": str(self.tuning), "values": asdict(self.tuning), **timed, "fault": self.fault}


@dataclass
class Runner:
    """A trial in a race, with the denoiser that is timed."""

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
        Time for the search; the rounds that a result needs at least may take longer.

    Attributes
    ----------
    trials : list of Trial
        Every tuning tried, in order; the default first.
    untried : int
        Number of candidates for which there was no time.
    reference : Trial
        The default's results in the final, or in all races if there was no final.
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
        """Number of steps of a search, for a progress bar."""
        return sum(map(len, self._choices.values())) + 1

    def race_copies(self, tuning: Tuning) -> Trial | None:
        """Race copies through pinned memory against direct copies, after `search`.

        Parameters
        ----------
        tuning : Tuning
            The tuning that `search` found, with direct copies.

        Returns
        -------
        Trial, optional
            `tuning` with pinned copies; use it if it `is_faster`. None if the device works in the host's memory, so
            that almost nothing is copied.
        """
        if shares_memory(self._queue.device):
            return None
        direct, pinned = Trial(tuning), Trial(replace(tuning, pinned_copies=True))
        runners = [self._enter(direct), self._enter(pinned)]
        self._run(runners, FINAL_ROUNDS, time.monotonic() + FINAL_SHARE * self._seconds, self._milliseconds_of_call)
        return pinned

    def search(self, advance: Callable[[], None] = lambda: None) -> Trial:
        """Race the candidates, and then the best of them against the default in a final.

        Parameters
        ----------
        advance : callable
            Called `steps` times, for a progress bar.

        Returns
        -------
        Trial
            The best candidate's results in the final. Use its tuning if it `is_faster`, else the default.

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
        """Reasons not to store the result; empty if there are none."""
        found = []
        if self.untried:
            found.append(f"no time was left for {self.untried} candidates")
        if self.reference.wavering > STEADY:
            found.append(f"the default's own time varies by {self.reference.wavering:.0%}, more than {STEADY:.0%}")
        return found

    def _race(self, best: Trial, knob: str, deadline: float, advance: Callable[[], None]) -> Trial:
        """Return the fastest of the default, `best`, and the variants of `best` with other values of one knob."""
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
        """Return a runner for a tuning; none if it was tried before, fails, or comes too late."""
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
        """Return what a tuning sets at this size; equal results mean equal launches."""
        return *tuning.defines.values(), tuning.work_group, Layout(*self._shape, tuning.row_alignment).pitch

    def _enter(self, trial: Trial) -> Runner:
        """Warm up a trial's denoiser; raise `SvgfError` if its result is not the default's."""
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
        """Time runners against the first, in turn, frame by frame.

        There are rounds[0] frames, and up to rounds[1] before the deadline. `clock` times a frame in ms; the default is
        the time on the device.
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
        """Denoise a frame, and return its time on the device."""
        denoiser.denoise(frame, out=self._out)
        return sum(denoiser.profile().values())

    def _milliseconds_of_call(self, denoiser: Denoiser, frame: Frame) -> float:
        """Denoise a frame, and return the time of the whole call from numpy arrays to a numpy array."""
        begin = time.perf_counter()
        denoiser.denoise(frame, out=self._out)
        return 1e3 * (time.perf_counter() - begin)
