"""Measures the error that is reported with every speed: the whole filter on a device against the float64 oracle."""

from __future__ import annotations

import numpy as np
import pyopencl as cl

from svgf_cl.denoiser import Denoiser
from svgf_cl.filters.filter import Filter
from svgf_cl.io.synthetic import room_frames
from svgf_cl.oracle import oracle_of

ERROR_SHAPE = (90, 160)  # the oracle is slow


def error_to_oracle(
    settings: Filter, *, signals: int = 1, frames: int = 6, queue: cl.CommandQueue | None = None
) -> tuple[float, float]:
    """Return the greatest and the root-mean-square difference of device and oracle, relative to the picture's mean.

    Both denoise the same sequence from its first frame on, each with its own history. Both errors are over all frames.
    """
    den, oracle = Denoiser(ERROR_SHAPE, settings=settings, queue=queue), oracle_of(settings, ERROR_SHAPE)
    errors = []
    for frame in room_frames(ERROR_SHAPE, frames, signals=signals):
        expected = oracle.denoise(frame)
        errors.append(np.abs(den.denoise(frame) - expected) / expected.mean())
    return float(np.max(errors)), float(np.sqrt(np.mean(np.square(errors))))
