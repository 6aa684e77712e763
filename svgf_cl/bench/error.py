"""The error that stands beside every speed: the whole filter on a device against the float64 oracle."""

from __future__ import annotations

import numpy as np
import pyopencl as cl

from svgf_cl.denoiser import Denoiser
from svgf_cl.io.synthetic import room_frames
from svgf_cl.oracle.svgf import Reference
from svgf_cl.settings import Settings

ERROR_SHAPE = (90, 160)  # the oracle is slow


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
