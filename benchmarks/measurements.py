"""Measures the time and the error of each variant."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import cycle

import numpy as np

from benchmarks.footage import Footage
from benchmarks.variants import Variant
from svgf_cl import Denoiser, Frame
from svgf_cl.bench import error_to_oracle
from svgf_cl.bench.rig import WARM_UP
from svgf_cl.compare.metrics import flip, psnr, relmse, temporal_error
from svgf_cl.frame import Shape
from svgf_cl.io.display import Linear, display
from svgf_cl.io.synthetic import PERIOD, room_frames

# Frames that a variant computes in each turn; the first one finds caches full of another variant's data.
UNTIMED, TIMED = 1, 2

Advance = Callable[[], None]


@dataclass(frozen=True)
class Quality:
    """Errors of the two measured frames of a sequence, as defined in `svgf_cl.compare.metrics`; means over the two."""

    psnr: float
    relmse: float
    flip: float
    temporal: float


@dataclass(frozen=True)
class Times:
    """Milliseconds per frame, by `paired_medians`: `device` is the sum of all passes, `frame` the whole call."""

    device: float
    frame: float


@dataclass(frozen=True)
class Result:
    """All measurements of one variant.

    Parameters
    ----------
    variant : Variant
    times : Times
    oracle_rms, oracle_largest : float
        Difference from the float64 oracle with the same settings, relative to the picture's mean.
    quality : dict of str to Quality
        Compared with the path-traced truth, by the footage's name.
    """

    variant: Variant
    times: Times
    oracle_rms: float
    oracle_largest: float
    quality: dict[str, Quality]


@dataclass
class Runner:
    """A variant's denoiser, which filters the same frames again and again."""

    den: Denoiser
    frames: Iterator[Frame]
    out: Linear
    device: list[float] = field(default_factory=list)
    host: list[float] = field(default_factory=list)

    @classmethod
    def of(cls, variant: Variant, frames: Sequence[Frame]) -> Runner:
        """A runner for `frames`, after a warm-up."""
        shape = frames[0].shape
        runner = cls(Denoiser(shape, settings=variant.settings), cycle(frames), np.empty((*shape, 3), np.float32))
        runner.run(WARM_UP)
        return runner

    def run(self, frames: int) -> None:
        """Denoise `frames` frames without timing them."""
        for _ in range(frames):
            self.den.denoise(next(self.frames), out=self.out)

    def time(self, frames: int) -> None:
        """Denoise `frames` frames, and record the milliseconds of each."""
        for _ in range(frames):
            begin = time.perf_counter()
            self.run(1)
            self.host.append(1e3 * (time.perf_counter() - begin))
            self.device.append(sum(self.den.profile().values()))


def interleaved_times(variants: Sequence[Variant], shape: Shape, rounds: int, advance: Advance) -> list[Times]:
    """Time the variants in turns, so that other work on the machine affects all of them alike.

    Parameters
    ----------
    variants : sequence of Variant
    shape : (int, int)
        (height, width) in pixels.
    rounds : int, >= 1
        Turns of each variant, of `TIMED` frames each.
    advance : callable
        Called after every turn: ``len(variants) * rounds`` times.
    """
    inputs = {n: list(room_frames(shape, PERIOD, signals=n)) for n in sorted({v.signals for v in variants})}
    runners = [Runner.of(variant, inputs[variant.signals]) for variant in variants]
    for _ in range(rounds):
        for runner in runners:
            runner.run(UNTIMED)
            runner.time(TIMED)
            advance()
    device, host = (paired_medians([getattr(runner, clock) for runner in runners]) for clock in ("device", "host"))
    return [Times(*pair) for pair in zip(device, host, strict=True)]


def paired_medians(samples: Sequence[Sequence[float]]) -> list[float]:
    """Medians of times that were taken in turns; they are reliable even on a busy machine.

    The first is a plain median. Each other one is the first median times the median ratio of both times of a turn,
    which other work on the machine changes little.

    Parameters
    ----------
    samples : (V, N) of float
        The times of each variant, turn by turn.
    """
    times = np.asarray(samples)
    medians: list[float] = (np.median(times[0]) * np.median(times / times[0], axis=1)).tolist()
    return medians


def qualities(
    variants: Sequence[Variant], footage: Footage, advance: Advance
) -> tuple[dict[Variant, Quality], Quality]:
    """Denoise a footage with every variant that suits it, and compare the pictures with the truth.

    Returns
    -------
    found : dict of Variant to Quality
        For those variants that are `suited`.
    noise : Quality
        One half of the truth compared with the other. Their mean, with which variants are compared, is 6 dB better.
    """
    halves = footage.halves(advance)
    truth = [0.5 * (first + second) for first, second in halves]
    pictures = judged_pictures(suited(variants, footage), footage, advance)
    found = {variant: quality(picture, truth) for variant, picture in pictures.items()}
    return found, quality([first for first, _ in halves], [second for _, second in halves])


def judged_pictures(variants: Sequence[Variant], footage: Footage, advance: Advance) -> dict[Variant, list[Linear]]:
    """The measured rows of the measured frames, denoised by each variant; `advance` is called after each frame."""
    denoisers = {variant: Denoiser(footage.shape, settings=variant.settings) for variant in variants}
    pictures: dict[Variant, list[Linear]] = {variant: [] for variant in variants}
    for number, split in enumerate(footage.noisy()):
        frames = {1: replace(split, direct=None, indirect=None), 2: split}
        for variant, den in denoisers.items():
            picture = den.denoise(frames[variant.signals])
            if number in footage.judged:
                pictures[variant].append(picture[slice(*footage.rows)])
        advance()
    return pictures


def quality(pictures: Sequence[Linear], truth: Sequence[Linear]) -> Quality:
    """Compare two consecutive linear pictures with the truth."""
    pairs = list(zip(pictures, truth, strict=True))
    shown = [(display(picture), display(wanted)) for picture, wanted in pairs]
    (earlier, earlier_truth), (later, later_truth) = shown
    return Quality(
        psnr=float(np.mean([psnr(*pair) for pair in shown])),
        relmse=float(np.mean([relmse(*pair) for pair in pairs])),
        flip=float(np.mean([flip(*pair) for pair in shown])),
        temporal=temporal_error((earlier, later), (earlier_truth, later_truth)),
    )


def suited(variants: Sequence[Variant], footage: Footage) -> list[Variant]:
    """Those variants that a footage can measure: temporal antialiasing needs jitter."""
    return [variant for variant in variants if footage.jitter or not variant.settings.taa]


def measure(
    variants: Sequence[Variant], footages: Sequence[Footage], shape: Shape, rounds: int, advance: Advance
) -> tuple[list[Result], dict[str, Quality]]:
    """Measure every variant; `advance` is called `steps` times.

    Returns
    -------
    results : list of Result
        In the order of `variants`.
    noise : dict of str to Quality
        The noise of each footage's truth, by name, as in `qualities`.
    """
    judged = {footage.name: qualities(variants, footage, advance) for footage in footages}
    times = interleaved_times(variants, shape, rounds, advance)
    results = []
    for variant, spent in zip(variants, times, strict=True):
        largest, rms = error_to_oracle(variant.settings, signals=variant.signals)
        quality_of = {name: found[variant] for name, (found, _) in judged.items() if variant in found}
        results.append(Result(variant, spent, rms, largest, quality_of))
        advance()
    return results, {name: noise for name, (_, noise) in judged.items()}


def steps(variants: Sequence[Variant], footages: Sequence[Footage], rounds: int) -> int:
    """The number of times that `measure` calls `advance`."""
    judging = sum(footage.chunks + footage.frames for footage in footages)
    return judging + len(variants) * (rounds + 1)
