"""Mean and spread of a picture's samples, gathered in parts that can be put together."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from .compiled import compiled
from .vectors import Float32, Float64

# Squared radiance below which errors count as absolute: as in `svgf_cl.compare.metrics.relmse`.
DARK = 0.01


class Step(NamedTuple):
    """What the part that made an estimate of so many samples per pixel told of their relative variance."""

    spp: int
    variance: float


@dataclass(frozen=True, eq=False)
class Estimate:
    """What N pixels converge to, as far as `spp` independent samples of each tell.

    Parameters
    ----------
    spp : int
        Samples per pixel, >= 0.
    light : (N, 5, 3) float32
        The mean of each kind of light, in the order of `tracer.paths`.
    squares : (N, 3) float32
        Sum over the samples of the squared difference between colour and mean colour.
    history : tuple of Step
        The estimates that this one has grown out of, one for each part that was merged; the last is itself.
    """

    spp: int
    light: Float32
    squares: Float32
    history: tuple[Step, ...] = ()

    @classmethod
    def nothing(cls, pixels: int) -> Estimate:
        """No sample of so many pixels."""
        return cls(0, np.zeros((pixels, 5, 3), np.float32), np.zeros((pixels, 3), np.float32))

    @classmethod
    def of(cls, samples: Iterable[Float32]) -> Estimate:
        """What single samples (N, 5, 3), at least one, tell."""
        remaining = iter(samples)
        light = next(remaining).copy()
        squares, alone, spp = np.zeros((len(light), 3), np.float32), np.zeros((len(light), 3), np.float32), 1
        for sample in remaining:
            _merge(light, squares, spp, sample, alone, 1)
            spp += 1
        return cls(spp, light, squares)

    @classmethod
    def beside(cls, parts: Iterable[Estimate]) -> Estimate:
        """What estimates of as many samples tell of all their pixels, one part after the other."""
        parts = list(parts)
        light, squares = (np.concatenate([getattr(part, name) for part in parts]) for name in ("light", "squares"))
        return cls(parts[0].spp, light, squares)

    def merged(self, other: Estimate) -> Estimate:
        """What the samples of both tell; the other ones are at least two and none of these."""
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
        """Estimated standard deviation (N, 3) of `color`; infinite where there are too few samples to tell."""
        if self.spp < 2:
            return np.full_like(self.squares, np.inf)
        error: Float32 = np.sqrt(self.squares / np.float32(self.spp * (self.spp - 1)))
        return error

    @property
    def errors(self) -> Float64:
        """Estimated relative error of each estimate in `history`.

        Its square is the relMSE to be expected between the estimate and the truth: the relative variance of a sample,
        divided by their number. That variance is a mean of what the parts tell. Each is too large while the mean that
        it is relative to is uncertain, by a share that falls with the samples before it; hence their square as weight.
        """
        spp, variance = np.array(self.history, np.float64).reshape(-1, 2).T
        weight = np.concatenate([[1.0], spp[:-1] ** 2])
        errors: Float64 = np.sqrt(np.cumsum(weight * variance) / np.cumsum(weight) / spp)
        return errors

    @property
    def error(self) -> float:
        """The last of `errors`; infinite where there is none."""
        return float(self.errors[-1]) if self.history else np.inf


def _relative_variance(variance: Float32, color: Float32) -> float:
    """Mean over pixels and channels of ``variance / (color**2 + DARK)``, independent estimates of both.

    Were they of the same samples, a rare bright one would hide behind the mean that it has raised itself.
    """
    relative = variance / (np.square(color) + np.float32(DARK))
    return float(relative.mean(dtype=np.float64))


@compiled
def _merge(
    light: Float32, squares: Float32, count: int, other_light: Float32, other_squares: Float32, other_count: int
) -> None:
    """Add other samples to the mean `light` and the `squares` of `count` samples, in place.

    The formula is that of Chan, Golub, LeVeque, "Updating Formulae and a Pairwise Algorithm for Computing Sample
    Variances" (1979): nothing cancels, however far the mean is from zero.
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
