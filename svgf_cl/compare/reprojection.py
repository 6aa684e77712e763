"""Where the surface of each pixel was in the frame before, by exact motion, and whether it was seen there.

A pixel p was at ``p + motion``, between four pixels of the frame before. Which of them show the same surface is decided
as the oracle decides it (`svgf_cl.oracle.temporal.consistent`): the same id where there are ids, the depth that motion
and slope let expect, a normal turned by less than 26 degrees, inside the image. The sky is no surface.
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

LEAST = 0.01  # weight of a tap that counts: motion is known to a hundredth of a pixel at best


@dataclass(frozen=True, eq=False)
class Reprojection:
    """The four pixels of the frame before around the place where each pixel's surface was.

    Parameters
    ----------
    rows, columns : (4, H, W)
        Clamped into the image.
    weight : (4, H, W)
        Bilinear; adds up to 1.
    inside, same : (4, H, W) bool
        Whether they lie in the image; whether they show the same surface.
    hit : (H, W) bool
        Where there is a surface now.
    """

    rows: Indices
    columns: Indices
    weight: Array
    inside: Mask
    same: Mask
    hit: Mask

    @classmethod
    def between(cls, earlier: Frame, later: Frame) -> Reprojection:
        """Find the pixels of the earlier one of two consecutive frames."""
        past, now = (demodulate(frame)[1] for frame in (earlier, later))
        x, y, weight = bilinear_taps(reprojected(now.motion))
        rows, columns, inside = locate(x, y, later.shape)
        return cls(rows, columns, weight, inside, consistent(x, y, now, past, Settings()), now.hit)

    @cached_property
    def seen(self) -> Mask:
        """Which of the four show the same surface and count, (4, H, W)."""
        return self.same & self._counts

    @cached_property
    def found(self) -> Mask:
        """Where all that is mixed of the frame before shows the same surface, (H, W)."""
        return self.hit & (self.seen | ~self._counts).all(axis=0)

    @cached_property
    def uncovered(self) -> Mask:
        """Where nothing of the frame before shows the same surface, though it was in the image, (H, W)."""
        return self.hit & (self.inside | ~self._counts).all(axis=0) & ~self.seen.any(axis=0)

    @cached_property
    def nearest(self) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Row and column, (H, W), of the nearest of the four, among those of the same surface if there are any."""
        chosen = np.argmax(self.weight + self.seen, axis=0)[None]
        return np.take_along_axis(self.rows, chosen, 0)[0], np.take_along_axis(self.columns, chosen, 0)[0]

    def warped(self, earlier: Linear) -> Linear:
        """A picture of the frame before, (H, W, 3), where its surfaces are now; bilinear."""
        picture: Linear = np.einsum("thw,thwc->hwc", self.weight, earlier[self.rows, self.columns])
        return picture

    @property
    def _counts(self) -> Mask:
        counts: Mask = self.weight >= LEAST
        return counts
