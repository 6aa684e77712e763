"""Mean and variance of a picture's samples, computed in parts that can be merged."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from .compiled import compiled
from .vectors import Float32, Float64

# Squared radiance below which errors are absolute: as in `svgf_cl.compare.metrics.relmse`.
DARK = 0.01


class Step(NamedTuple):
    """A part of an estimate: the samples per pixel after it was added, and the relative variance of a sample in it."""

    spp: int
    variance: float


@dataclass(frozen=True, eq=False)
class Estimate:
    """An estimate of the light of N pixels, from `spp` independent samples per pixel.

    Parameters
    ----------
    spp : int
        Samples per pixel, >= 0.
    light : (N, 5, 3) float32
        The mean of each kind of light, in the order of `tracer.paths`.
    squares : (N, 3) float32
        Sum over the samples of the squared difference between colour and mean colour.
    history : tuple of Step
        The steps in which this estimate grew, one for each merged part; the last one is this estimate itself.
    """

    spp: int
    light: Float32
    squares: Float32
    history: tuple[Step, ...] = ()

    @classmethod
    def nothing(cls, pixels: int) -> Estimate:
        """An estimate without samples."""
        return cls(0, np.zeros((pixels, 5, 3), np.float32), np.zeros((pixels, 3), np.float32))

    @classmethod
    def of(cls, samples: Iterable[Float32]) -> Estimate:
        """The estimate from single samples (N, 5, 3), at least one."""
        remaining = iter(samples)
        light = next(remaining).copy()
        squares, alone, spp = np.zeros((len(light), 3), np.float32), np.zeros((len(light), 3), np.float32), 1
        for sample in remaining:
            _merge(light, squares, spp, sample, alone, 1)
            spp += 1
        return cls(spp, light, squares)

    @classmethod
    def beside(cls, parts: Iterable[Estimate]) -> Estimate:
        """Join estimates with the same number of samples into one estimate of all their pixels, in this order."""
        parts = list(parts)
        light, squares = (np.concatenate([getattr(part, name) for part in parts]) for name in ("light", "squares"))
        return cls(parts[0].spp, light, squares)

    def merged(self, other: Estimate) -> Estimate:
        """The estimate from the samples of both; `other` has at least two samples, and none of these."""
        light, squares = self.light.copy(), self.squares.copy()
        _merge(light, squares, self.spp, other.light, other.squares, other.spp)
        spp, expected = self.spp + other.spp, self if self.spp else other
        step = Step(spp, _relative_variance(other.squares / np.float32(other.spp - 1), expected.color))
        return Estimate(spp, light, squares, (*self.history, step))

    @property
    def color(self) -> Float32:
        """The mean colour (N, 3)."""
        color: Float32 = np.einsum("nkc->nc", self.light)
        return color

    @property
    def standard_error(self) -> Float32:
        """Estimated standard deviation (N, 3) of `color`; infinite with too few samples."""
        if self.spp < 2:
            return np.full_like(self.squares, np.inf)
        error: Float32 = np.sqrt(self.squares / np.float32(self.spp * (self.spp - 1)))
        return error

    @property
    def errors(self) -> Float64:
        """Estimated relative error of each estimate in `history`.

        Its square is the expected relMSE between the estimate and the truth: the relative variance of a sample, divided
        by the number of samples. This variance is a weighted mean over the parts. The variance of a part is too large
        while the mean by which it is divided is uncertain. This excess decreases with the number of samples before the
        part, so the weight of a part is the square of that number.
        """
        spp, variance = np.array(self.history, np.float64).reshape(-1, 2).T
        weight = np.concatenate([[1.0], spp[:-1] ** 2])
        errors: Float64 = np.sqrt(np.cumsum(weight * variance) / np.cumsum(weight) / spp)
        return errors

    @property
    def error(self) -> float:
        """The last of `errors`; infinite if there is none."""
        return float(self.errors[-1]) if self.history else np.inf


def _relative_variance(variance: Float32, color: Float32) -> float:
    """Mean over pixels and channels of ``variance / (color**2 + DARK)``, of independent estimates of both.

    If both were from the same samples, a rare bright sample would raise the mean and so hide its own variance.
    """
    relative = variance / (np.square(color) + np.float32(DARK))
    return float(relative.mean(dtype=np.float64))


@compiled
def _merge(
    light: Float32, squares: Float32, count: int, other_light: Float32, other_squares: Float32, other_count: int
) -> None:
    """Add other samples to the mean `light` and the `squares` of `count` samples, in place.

    The formula is from Chan, Golub, LeVeque, "Updating Formulae and a Pairwise Algorithm for Computing Sample
    Variances" (1979). It loses no digits by cancellation, however far the mean is from zero.
    """
    total = count + other_count
    share, spread = np.float32(other_count / total), np.float32(count * other_count / total)
    for pixel in range(len(light)):
        for channel in range(3):
            color = np.float32(0.0)
            for kind in range(5):
                difference = other_light[pixel, kind, channel] - light[pixel, kind, channel]
                light[pixel, kind, channel] += difference * share
                color += difference
            squares[pixel, channel] += other_squares[pixel, channel] + color * color * spread
