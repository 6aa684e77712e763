"""Stability: how much more pictures change over time than the truth does.

=======  ==========================  ==================================================================================
measure  where                       definition
=======  ==========================  ==================================================================================
flicker  on surfaces that rest in    ``sqrt(mean(var(p))) - sqrt(mean(cov(h1, h2)))``, variance and covariance of a
         all frames                  pixel's channels over time
warped   on surfaces that the        ``sqrt(mean(d d)) - sqrt(mean(d1 d2))``, where d, d1 and d2 are the differences of
         previous frame shows too    picture and halves from their predecessors, warped bilinearly by exact motion
=======  ==========================  ==================================================================================

Both are display-referred, in -1..1, and 0 if a picture changes as much as the truth. A picture above 0 flickers. A
picture below 0 is steadier than the truth: it lags, or it is blurred. Because squares are added, a little more change
hardly counts where the truth itself changes much; so both measures are most sensitive where the light is constant. The
truth's noise does not count, because h1 and h2 are independent halves of it (`svgf_cl.compare.halves`). Both are NaN if
there is no such surface.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from svgf_cl.compare.halves import Mask, Pair
from svgf_cl.compare.reprojection import Reprojection
from svgf_cl.compare.share import Share
from svgf_cl.io.display import Linear


class Covariance:
    """Covariance over time of two series of pictures, for each value, from one pair of pictures at a time.

    It is the sample covariance: divided by one less than the number of pictures. It needs the memory of three pictures
    in 32-bit floats; these are precise enough, as they hold means and deviations (Welford's method), not sums of
    squares.
    """

    def __init__(self) -> None:
        self._count = 0
        self._first = self._second = self._product = np.zeros((), np.float32)

    def add(self, first: Linear, second: Linear) -> None:
        """Add the next picture of each series, (H, W, 3)."""
        self._count += 1
        deviation = first - self._first
        self._first = (self._first + deviation / self._count).astype(np.float32)
        self._product = (self._product + deviation * (second - self._second) * (1 - 1 / self._count)).astype(np.float32)
        self._second = (self._second + (second - self._second) / self._count).astype(np.float32)

    @property
    def value(self) -> NDArray[np.float64]:
        """The covariance, (H, W, 3); NaN for fewer than two pictures."""
        return np.asarray(self._product, np.float64) / (self._count - 1 if self._count > 1 else np.nan)


class Flicker:
    """Flicker of pictures on resting surfaces, computed from one picture at a time."""

    def __init__(self) -> None:
        self._picture, self._truth = Covariance(), Covariance()
        self._resting: Mask = np.ones((), np.bool_)

    def see(self, shown: Linear, halves: Pair, resting: Mask) -> None:
        """Add the next display-referred picture, the halves of its truth, and where its surfaces rest."""
        self._picture.add(shown, shown)
        self._truth.add(*halves)
        self._resting = self._resting & resting

    @property
    def value(self) -> float:
        """The flicker, as defined above; NaN for fewer than two pictures."""
        variances = (series.value[self._resting] for series in (self._picture, self._truth))
        return excess(*(Share(float(variance.sum()), variance.size) for variance in variances))


def residual(earlier: Pair, later: Pair, past: Reprojection) -> Share:
    """Return the product of two series' differences from their warped predecessors, and the number of values.

    The series are the halves of the truth, or the same picture twice.
    """
    differences = [(now - past.warped(before))[past.found] for before, now in zip(earlier, later, strict=True)]
    return Share(float(np.sum(differences[0] * differences[1])), differences[0].size)


def excess(picture: Share, truth: Share) -> float:
    """Return the root of a picture's mean square less the root of the truth's."""
    return root(picture.value) - root(truth.value)


def root(square: float) -> float:
    """Return the square root; 0 for a negative number, as the estimate of a very small square may be negative."""
    return float(np.sqrt(np.maximum(square, 0.0)))
