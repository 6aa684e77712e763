"""Finds each pixel's surface in the previous frame, by exact motion, and whether it was visible there.

A pixel p was at ``p + motion``, between four pixels of the previous frame. One of them shows the same surface if the
oracle says so (`svgf_cl.oracle.temporal.consistent`): it lies inside the image and has the same id (if there are ids),
the depth expected from motion and slope, and a normal turned by less than 26 degrees. The sky is no surface.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from svgf_cl.compare.halves import Mask
from svgf_cl.filters import Settings
from svgf_cl.frame import Frame
from svgf_cl.io.display import Linear
from svgf_cl.oracle.taps import Array, Indices, bilinear_taps, locate, reprojected
from svgf_cl.oracle.temporal import consistent, demodulate

LEAST = 0.01  # least weight of a tap that counts: motion is exact to a hundredth of a pixel at best


@dataclass(frozen=True, eq=False)
class Reprojection:
    """The four pixels of the previous frame around the place where each pixel's surface was.

    Parameters
    ----------
    rows, columns : (4, H, W)
        Their positions, clamped to the image.
    weight : (4, H, W)
        Their bilinear weights, whose sum is 1.
    inside, same : (4, H, W) bool
        Whether they lie in the image, and whether they show the same surface.
    hit : (H, W) bool
        Where the current frame shows a surface.
    """

    rows: Indices
    columns: Indices
    weight: Array
    inside: Mask
    same: Mask
    hit: Mask

    @classmethod
    def between(cls, earlier: Frame, later: Frame) -> Reprojection:
        """Find the pixels in the earlier of two consecutive frames."""
        past, now = (demodulate(frame)[1] for frame in (earlier, later))
        x, y, weight = bilinear_taps(reprojected(now.motion))
        rows, columns, inside = locate(x, y, later.shape)
        return cls(rows, columns, weight, inside, consistent(x, y, now, past, Settings()), now.hit)

    @cached_property
    def seen(self) -> Mask:
        """The pixels of the four that count and show the same surface, (4, H, W)."""
        return self.same & self._counts

    @cached_property
    def found(self) -> Mask:
        """The surface's pixels for which all of the four that count show the same surface, (H, W)."""
        return self.hit & (self.seen | ~self._counts).all(axis=0)

    @cached_property
    def uncovered(self) -> Mask:
        """The surface's pixels for which none of the four shows the same surface, though they are inside, (H, W)."""
        return self.hit & (self.inside | ~self._counts).all(axis=0) & ~self.seen.any(axis=0)

    @cached_property
    def nearest(self) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Row and column, (H, W), of the nearest of the four; of those that show the same surface if any does."""
        chosen = np.argmax(self.weight + self.seen, axis=0)[None]
        return np.take_along_axis(self.rows, chosen, 0)[0], np.take_along_axis(self.columns, chosen, 0)[0]

    def warped(self, earlier: Linear) -> Linear:
        """Return a picture of the previous frame, (H, W, 3), warped bilinearly to where its surfaces are now."""
        picture: Linear = np.einsum("thw,thwc->hwc", self.weight, earlier[self.rows, self.columns])
        return picture

    @property
    def _counts(self) -> Mask:
        counts: Mask = self.weight >= LEAST
        return counts
