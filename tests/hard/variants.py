"""The ways to run the filter, of which each hard case goes through those that can change its outcome.

Each file says at its top which these are and why, in `on(...)`. And how far each may lie off the oracle.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

from svgf_cl import Denoiser, Frame, Kalman, Settings
from svgf_cl.filters.temporal import TemporalFilter
from svgf_cl.frame import REQUIRED, Shape
from svgf_cl.oracle import oracle_of
from svgf_cl.oracle.rounding import largest_channel
from tests.frames import FULL, SHAPE, SPLIT, only, wall

# Share of pixels that may be further off: where a tap lies within rounding of a threshold, it counts for one alone.
DECIDED_OTHERWISE = 1e-3


@dataclass(frozen=True)
class Variant:
    """Settings, how many signals the light comes in, and bounds.

    Parameters
    ----------
    settings : TemporalFilter
    signals : int, 1 or 2
    rounding : float
        Largest relative error of a value that is stored and read again, once for each stage it passes.
    error : float
        Largest relative error of a pixel to the oracle over a sequence; two to three times what was measured on frames
        in which nothing fits anything else.
    outshone : float
        The same where a pixel shows nothing but a faint trace of others, brighter by many powers of ten: weights of
        exp(-x) with x up to 80 multiply what rounding, or the fast weights of other levels, made of x.
    greatest, least : float, radiance
        What illumination saturates at, and the step below which it cannot be told from black.
    """

    settings: TemporalFilter
    signals: int
    rounding: float
    error: float
    outshone: float
    greatest: float = 1e15
    least: float = 0.0

    @property
    def fields(self) -> tuple[str, ...]:
        """What a frame of it holds beside the surface; with few sets there are few kernels to compile."""
        return SPLIT if self.signals == 2 else FULL

    def wall(self, light: Any = 0.5, *, emission: Any = 0.0, shape: Shape = SHAPE, **given: Any) -> Frame:
        """A wall with all `fields`, that reflects this light; numbers and triples fill the image."""
        light, emission = np.asarray(light, np.float32), np.asarray(emission, np.float32)
        lights = {"color": light + emission, "direct": 0.75 * light, "indirect": 0.25 * light, "emission": emission}
        return only(wall(shape, **lights | {"albedo": 1.0, "id": 1} | given), self.fields)

    def denoiser(self, shape: Shape = SHAPE, **kept: Any) -> Denoiser:
        """A denoiser with these settings."""
        return Denoiser(shape, settings=self.settings, **kept)

    def pictures(self, frames: Iterable[Frame], shape: Shape = SHAPE) -> Iterator[np.ndarray]:
        """What the device makes of each frame of a sequence."""
        return map(self.denoiser(shape).denoise, frames)

    def expected(self, frames: Iterable[Frame], shape: Shape = SHAPE) -> Iterator[np.ndarray]:
        """What the oracle makes of each frame of a sequence."""
        return map(oracle_of(self.settings, shape).denoise, frames)

    def assert_follows_oracle(self, frames: Iterable[Frame], shape: Shape = SHAPE, error: float | None = None) -> None:
        """Every pixel of every picture is finite and, but for a few, within `error` of the oracle's."""
        frames = list(frames)
        for number, (got, expected) in enumerate(
            zip(self.pictures(frames, shape), self.expected(frames, shape), strict=True)
        ):
            assert np.isfinite(got).all(), f"frame {number}"
            off = self.errors(got, expected)
            worst = np.quantile(off, 1 - DECIDED_OTHERWISE, method="higher")
            assert worst <= (error or self.error), f"frame {number}: {worst:.2e}, largest {off.max():.2e}"

    def errors(self, got: np.ndarray, expected: np.ndarray) -> np.ndarray:
        """Error of each pixel relative to its greatest channel, (H, W), beside the step to black."""
        size = largest_channel(expected)[..., 0]
        steps = 4 * self.signals * self.least  # a handful of stages
        off: np.ndarray = np.maximum(np.abs(got - expected).max(axis=-1) - steps, 0) / np.where(size > 0, size, 1)
        return off


# float32 rounds by 2^-24, 16-bit floats by 2^-11 at most, normals by 2^-16; fast weights are up to 6 % larger.
PRECISE = {"rounding": 1e-6, "error": 1e-4, "outshone": 1e-3}
HALVES = {"rounding": 1e-3, "error": 1e-1, "outshone": 1e-1, "greatest": 65504.0, "least": 2.0**-24}
FAST = {"rounding": 1e-6, "error": 1e-1, "outshone": 2.0}
# How much of a change is believed goes by a variance of as few as two pixels, which cancels where they are alike.
KALMAN = {"rounding": 1e-6, "error": 6e-2, "outshone": 1e-1}
# TAA clamps chroma between neighbours: beside a light 1e6 times as bright, chroma is known to that one's rounding only.
OUTSHONE_CHROMA = {"outshone": 5e-2}

VARIANTS = {
    "precise": Variant(Settings(), 1, **PRECISE),
    "precise, two signals, TAA": Variant(Settings(taa=True), 2, **PRECISE | OUTSHONE_CHROMA),
    "fp16": Variant(Settings(half_guides=True, half_history=True), 1, **HALVES),
    "fp16, two signals, TAA": Variant(Settings(half_guides=True, half_history=True, taa=True), 2, **HALVES),
    "fast": Variant(Settings(precision="fast"), 1, **FAST),
    "fast, two signals, TAA": Variant(Settings(precision="fast", taa=True), 2, **FAST),
    "Kalman": Variant(Kalman(), 1, **KALMAN),
    "Kalman, two signals, TAA": Variant(Kalman(taa=True), 2, **KALMAN),
}


def on(*names: str) -> pytest.MarkDecorator:
    """Mark a test that goes through these variants."""
    return pytest.mark.parametrize("variant", names, indirect=True)


def on_each_field(*names: str) -> pytest.MarkDecorator:
    """Mark a test that goes through each field of float32, as `name`, of the frames of these variants."""
    cases = [
        pytest.param(variant, name, id=f"{variant}, {name}")
        for variant in names
        for name in (*REQUIRED, *VARIANTS[variant].fields)
        if name != "id"
    ]
    return pytest.mark.parametrize(("variant", "name"), cases, indirect=["variant"])
