"""Time per pass and per frame, beside the error against the oracle."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pyopencl as cl

from svgf_cl.denoiser import Denoiser
from svgf_cl.reference import Reference
from svgf_cl.room import PERIOD, room_frames
from svgf_cl.settings import Settings

WARM_UP = 5  # frames: kernels are built, memory is touched, history is long enough
ERROR_SHAPE = (90, 160)  # the oracle is slow


@dataclass(frozen=True)
class Timing:
    """Milliseconds over the timed frames.

    Parameters
    ----------
    name : str
        Pass, or "device" for all passes, or "frame" for the whole call of `Denoiser.denoise`, copies included.
    median, low, high : float, ms
        Median, 10th and 90th percentile.
    """

    name: str
    median: float
    low: float
    high: float

    @classmethod
    def of(cls, name: str, samples: list[float]) -> Timing:
        """Condense samples in milliseconds."""
        low, median, high = np.percentile(samples, (10, 50, 90))
        return cls(name, float(median), float(low), float(high))


def measure(
    den: Denoiser, frames: int, *, signals: int = 1, advance: Callable[[], None] = lambda: None
) -> list[Timing]:
    """Time `frames` frames of the built-in room.

    Parameters
    ----------
    den : Denoiser
        Its shape is that of the frames.
    frames : int, >= 1
    signals : int, 1 or 2
    advance : callable
        Called after each frame, for a progress bar.

    Returns
    -------
    list of Timing
        One a pass in order, then "device" and "frame".
    """
    inputs = list(room_frames(den.shape, PERIOD, signals=signals))
    out = np.empty((*den.shape, 3), np.float32)
    host: list[float] = []
    profiles: list[dict[str, float]] = []
    for index in range(WARM_UP + frames):
        begin = time.perf_counter()
        den.denoise(inputs[index % PERIOD], out=out)
        if index >= WARM_UP:
            host.append(1e3 * (time.perf_counter() - begin))
            profiles.append(den.profile())
            advance()
    timings = [Timing.of(name, [profile[name] for profile in profiles]) for name in profiles[0]]
    device = Timing.of("device", [sum(profile.values()) for profile in profiles])
    return [*timings, device, Timing.of("frame", host)]


def error_to_oracle(
    settings: Settings, *, signals: int = 1, frames: int = 6, queue: cl.CommandQueue | None = None
) -> tuple[float, float]:
    """Greatest and root-mean-square difference between device and oracle, relative to the picture's mean.

    Both denoise the same sequence from its first frame on, each with its own history; both figures are over all of it.
    """
    den, oracle = Denoiser(ERROR_SHAPE, settings=settings, queue=queue), Reference(ERROR_SHAPE, settings)
    errors = []
    for frame in room_frames(ERROR_SHAPE, frames, signals=signals):
        expected = oracle.denoise(frame)
        errors.append(np.abs(den.denoise(frame) - expected) / expected.mean())
    return float(np.max(errors)), float(np.sqrt(np.mean(np.square(errors))))
