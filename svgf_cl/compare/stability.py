"""Stability: how much pictures change over time beyond what the truth does.

=======  ==========================  ==================================================================================
measure  where                       definition
=======  ==========================  ==================================================================================
flicker  on surfaces that rest in    ``sqrt(mean(var(p))) - sqrt(mean(cov(h1, h2)))``, variance and covariance of a
         all frames                  pixel's channels over time
warped   on surfaces found again in  ``sqrt(mean(d d)) - sqrt(mean(d1 d2))``, d, d1 and d2 being a picture's, or half's,
         the frame before            difference from its predecessor, warped by exact motion, bilinear
=======  ==========================  ==================================================================================

Both are display-referred, in -1..1, and 0 where a picture changes as much as the truth. Above 0 it flickers, below 0 it
is steadier than the truth: it lags, or it is blurred. Where the truth itself changes much, a little more hardly counts,
as squares add up: both tell most of light that rests. As h1 and h2 are independent halves of the truth, as in
`svgf_cl.compare.halves`, its noise does not count. NaN where there is no such surface.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from svgf_cl.compare.halves import Mask, Pair
from svgf_cl.compare.reprojection import Reprojection
from svgf_cl.compare.share import Share
from svgf_cl.io.display import Linear


class Covariance:
    """Covariance over time of two series of pictures, each value apart, from one pair of pictures at a time.

    It is that of a sample: divided by one less than the number of pictures. Memory: three pictures of 32-bit floats,
    which suffice, as they hold means and deviations (Welford's method) and not sums of squares.
    """

    def __init__(self) -> None:
        self._count = 0
        self._first = self._second = self._product = np.zeros((), np.float32)

    def add(self, first: Linear, second: Linear) -> None:
        """Take the next picture of each series, (H, W, 3)."""
        self._count += 1
        deviation = first - self._first
        self._first = (self._first + deviation / self._count).astype(np.float32)
        self._product = (self._product + deviation * (second - self._second) * (1 - 1 / self._count)).astype(np.float32)
        self._second = (self._second + (second - self._second) / self._count).astype(np.float32)

    @property
    def value(self) -> NDArray[np.float64]:
        """The covariance, (H, W, 3); NaN of less than two pictures."""
        return np.asarray(self._product, np.float64) / (self._count - 1 if self._count > 1 else np.nan)


class Flicker:
    """Flicker of pictures where the surfaces rest, from one picture at a time."""

    def __init__(self) -> None:
        self._picture, self._truth = Covariance(), Covariance()
        self._resting: Mask = np.ones((), np.bool_)

    def see(self, shown: Linear, halves: Pair, resting: Mask) -> None:
        """Take the next display-referred picture, its truth, and where its surfaces are those of the frame before."""
        self._picture.add(shown, shown)
        self._truth.add(*halves)
        self._resting = self._resting & resting

    @property
    def value(self) -> float:
        """As defined above; NaN of less than two pictures."""
        variances = (series.value[self._resting] for series in (self._picture, self._truth))
        return excess(*(Share(float(variance.sum()), variance.size) for variance in variances))


def residual(earlier: Pair, later: Pair, past: Reprojection) -> Share:
    """Product of two series' differences from their warped predecessors, of the number of values.

    The series are the halves of the truth, or a picture taken twice.
    """
    differences = [(now - past.warped(before))[past.found] for before, now in zip(earlier, later, strict=True)]
    return Share(float(np.sum(differences[0] * differences[1])), differences[0].size)


def excess(picture: Share, truth: Share) -> float:
    """Root of a picture's mean square less that of the truth's."""
    return root(picture.value) - root(truth.value)


def root(square: float) -> float:
    """The square root; 0 below 0, where the estimate of a square of next to nothing may lie."""
    return float(np.sqrt(np.maximum(square, 0.0)))
