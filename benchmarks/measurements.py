"""What each variant costs, and how far off it is."""

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

# Frames a variant computes at each of its turns: the first finds caches full of another variant's planes.
UNTIMED, TIMED = 1, 2

Advance = Callable[[], None]


@dataclass(frozen=True)
class Quality:
    """Errors of a sequence's two judged frames, as `svgf_cl.compare.metrics` defines them; means over the two."""

    psnr: float
    relmse: float
    flip: float
    temporal: float


@dataclass(frozen=True)
class Times:
    """Milliseconds a frame, by `paired_medians`: `device` sums all passes, `frame` is the whole call with copies."""

    device: float
    frame: float


@dataclass(frozen=True)
class Result:
    """Everything measured of one variant.

    Parameters
    ----------
    variant : Variant
    times : Times
    oracle_rms, oracle_largest : float
        Difference from the float64 oracle that does the same, relative to the picture's mean.
    quality : dict of str to Quality
        Against path-traced truth, by the footage's name.
    """

    variant: Variant
    times: Times
    oracle_rms: float
    oracle_largest: float
    quality: dict[str, Quality]


@dataclass
class Runner:
    """A variant's denoiser at work on frames that come round and round."""

    den: Denoiser
    frames: Iterator[Frame]
    out: Linear
    device: list[float] = field(default_factory=list)
    host: list[float] = field(default_factory=list)

    @classmethod
    def of(cls, variant: Variant, frames: Sequence[Frame]) -> Runner:
        """A runner on `frames`, warm."""
        shape = frames[0].shape
        runner = cls(Denoiser(shape, settings=variant.settings), cycle(frames), np.empty((*shape, 3), np.float32))
        runner.run(WARM_UP)
        return runner

    def run(self, frames: int) -> None:
        """Denoise so many frames, untimed."""
        for _ in range(frames):
            self.den.denoise(next(self.frames), out=self.out)

    def time(self, frames: int) -> None:
        """Denoise so many frames and note the milliseconds of each."""
        for _ in range(frames):
            begin = time.perf_counter()
            self.run(1)
            self.host.append(1e3 * (time.perf_counter() - begin))
            self.device.append(sum(self.den.profile().values()))


def interleaved_times(variants: Sequence[Variant], shape: Shape, rounds: int, advance: Advance) -> list[Times]:
    """Time the variants by turns, so that whatever else the machine does falls on all alike.

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
    """Medians of times taken by turns, steady where the machine is not.

    That of the first as it is; that of any other as the first's times the median ratio of the two in one turn, which
    what else the machine does changes little.

    Parameters
    ----------
    samples : (V, N) of float
        For each variant, its times turn by turn.
    """
    times = np.asarray(samples)
    medians: list[float] = (np.median(times[0]) * np.median(times / times[0], axis=1)).tolist()
    return medians


def qualities(
    variants: Sequence[Variant], footage: Footage, advance: Advance
) -> tuple[dict[Variant, Quality], Quality]:
    """Denoise a footage with every variant it suits, and hold each against the truth.

    Returns
    -------
    found : dict of Variant to Quality
        Of the variants that are `suited`.
    noise : Quality
        One half of the truth against the other. Their mean, which the variants are held against, is 6 dB closer.
    """
    halves = footage.halves(advance)
    truth = [0.5 * (first + second) for first, second in halves]
    pictures = judged_pictures(suited(variants, footage), footage, advance)
    found = {variant: quality(picture, truth) for variant, picture in pictures.items()}
    return found, quality([first for first, _ in halves], [second for _, second in halves])


def judged_pictures(variants: Sequence[Variant], footage: Footage, advance: Advance) -> dict[Variant, list[Linear]]:
    """The judged rows of the judged frames, as each variant denoises them; `advance` is called after each frame."""
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
    """Measure two consecutive linear pictures against the truth about them."""
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
    """Those variants that a footage can judge: temporal antialiasing needs jitter."""
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
        Of each footage's truth, by name, as in `qualities`.
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
    """How often `measure` will call `advance`."""
    judging = sum(footage.chunks + footage.frames for footage in footages)
    return judging + len(variants) * (rounds + 1)
