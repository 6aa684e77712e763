"""Variance of light far brighter than its noise: the paper's raw moments and the kernels' moments against float64."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np
import pyopencl as cl
from numpy.typing import NDArray

from benchmarks.markdown import markdown
from svgf_cl import Denoiser, Frame, Settings
from svgf_cl.frame import LUMINANCE
from svgf_cl.oracle.svgf import Oracle

SHAPE = (36, 64)
FRAMES = 24
LIGHT = 1e4
NOISE = (1e-1, 1e-2, 1e-3, 1e-4)

INTRODUCTION = f"""The last table is about the variance of steady light.
It has the error of the stage `moment_variance`: rms, relative to the mean variance.
The input is {FRAMES} frames with a luminance of {LIGHT:g} and normally distributed noise.
"Before" is the formula of the paper, `mu2 - mu1^2`, in float32.
"After" is mean and variance as `temporal.cl` stores them, in float32 and in 16-bit floats.
16-bit floats can store a deviation only to 1e-3 of the light.
"""


def steady_frames(noise: float, count: int = FRAMES, seed: int = 0) -> Iterator[Frame]:
    """A still wall; `noise` is the standard deviation of its light divided by `LIGHT`."""
    rng = np.random.default_rng(seed)
    for _ in range(count):
        light = LIGHT * (1 + noise * rng.standard_normal((*SHAPE, 1)))
        yield Frame(
            color=np.repeat(light, 3, axis=-1).astype(np.float32),
            normal=np.broadcast_to(np.array((0, 0, 1), np.float32), (*SHAPE, 3)),
            depth=np.full(SHAPE, 4, np.float32),
            motion=np.zeros((*SHAPE, 2), np.float32),
        )


def raw_moments(frames: Iterable[Frame], alpha: float) -> NDArray[np.float32]:
    """Variance as in Schied et al. 2017, section 4.2, in float32: mu2 - mu1^2, (H, W), at least 0."""
    first: NDArray[np.float32] = np.zeros(SHAPE, np.float32)
    second = first
    for age, frame in enumerate(frames):
        luminance = frame.color @ np.array(LUMINANCE, np.float32)
        share = np.float32(max(alpha, 1 / (age + 1)))
        first = first + share * (luminance - first)
        second = second + share * (luminance * luminance - second)
    variance: NDArray[np.float32] = np.maximum(second - first * first, 0)
    return variance


def kept_variance(denoiser: Denoiser, frames: Iterable[Frame]) -> NDArray[np.float32]:
    """Variance as the device stores it, (H, W)."""
    for frame in frames:
        denoiser.denoise(frame)
    variance: NDArray[np.float32] = denoiser.stage("moment_variance")[0]
    return variance


def exact_variance(frames: Iterable[Frame]) -> NDArray[np.float64]:
    """Variance as the oracle computes it, (H, W)."""
    oracle = Oracle(SHAPE, Settings())
    for frame in frames:
        oracle.denoise(frame)
    variance: NDArray[np.float64] = oracle.stages["moment_variance"][0]
    return variance


def errors(noise: float, queue: cl.CommandQueue | None = None) -> tuple[float, float, float]:
    """Rms error relative to the mean variance: of raw moments, of the kernels, and of the kernels with 16 bits."""
    frames = list(steady_frames(noise))
    expected = exact_variance(frames)
    settings = Settings(), Settings(half_history=True)
    found = [kept_variance(Denoiser(SHAPE, settings=chosen, queue=queue), frames) for chosen in settings]
    raw, single, half = (
        float(np.sqrt(np.mean(np.square(variance - expected))) / expected.mean())
        for variance in (raw_moments(frames, Settings().alpha_moments), *found)
    )
    return raw, single, half


def table(queue: cl.CommandQueue | None = None) -> str:
    """A markdown table with one row for each strength of noise."""
    rows = [[f"{noise:g}", *(f"{error:.1e}" for error in errors(noise, queue))] for noise in NOISE]
    return markdown(("noise", "before, float32", "after, float32", "after, 16 bits"), rows)


if __name__ == "__main__":
    print(f"{INTRODUCTION}\n{table()}", end="")
