"""Finds the parts of the previous frame that a tile reads along motion, cut into windows of a buffer's size."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from svgf_cl.filters.pipeline import Pass
from svgf_cl.frame import Shape

Motion = NDArray[np.float32]
Corner = tuple[int, int]  # row, column
FAR = 1e6  # pixels: such motion leads out of every image, as in kernels/reprojection.clh


@dataclass(frozen=True)
class Reach:
    """How far a pass reads, in pixels, to either side of p + motion rounded down to a whole pixel."""

    below: int
    above: int
    beside: int  # from a pixel to the one whose motion it uses

    @classmethod
    def of(cls, entry: Pass) -> Reach:
        """Return the reach of a pass's taps along motion, whichever neighbour's motion a pixel uses."""
        taps = [tap for each in entry.reads for tap in entry.taps(each) if tap.follow_motion]
        along = [distance for tap in taps for offset in tap.offsets for distance in offset]
        beside = max(entry.reach(each) for each in entry.reads if each.of == "motion")
        return cls(beside - min(along), beside + max(along), beside)

    @property
    def span(self) -> int:
        """Number of pixels read along an axis, less one."""
        return self.below + self.above


@dataclass(frozen=True, eq=False)
class PastWindow:
    """A window on the previous frame.

    Parameters
    ----------
    origin : (int, int)
        Row and column of the image where the window begins; the window lies inside the image.
    corner, size : (int, int)
        The part of the window that is read: first row and column in the image, height and width.
    readers : (h, w) bool, optional
        The pixels whose motion leads into this window; None for all pixels whose motion leads into the image.
    """

    origin: Corner
    corner: Corner
    size: Shape
    readers: NDArray[np.bool_] | None = None


def past_windows(motion: Motion, first: Corner, shape: Shape, window: Shape, reach: Reach) -> list[PastWindow]:
    """Return windows such that each pixel finds all its taps inside the image in one of them.

    One window is enough if motion is similar everywhere. Arbitrary motion takes as many windows as cover the image.

    Parameters
    ----------
    motion : (h, w, 2 or 3) float32
        The motion of a rectangle of pixels.
    first : (int, int)
        Row and column of the first of them.
    shape, window : (int, int)
        (height, width) of the image and of a window.
    reach : Reach
    """
    sides, most = np.array(shape), np.array(window)

    def placed(corner: NDArray[np.int64], end: NDArray[np.int64], readers: NDArray[np.bool_] | None) -> PastWindow:
        origin, size = np.minimum(corner, sides - most), end - corner
        return PastWindow(pair(origin), pair(corner), pair(size), readers)

    least, greatest = ends(motion, first, reach)
    corner, end = np.clip(least, 0, sides - 1), np.clip(greatest, 0, sides - 1) + 1
    if np.all(end - corner <= most):  # the extremes of motion are enough here, and much faster
        return [placed(corner, end, None)]

    low, high, used = taps_of(motion, first, shape, reach)
    if not used.any():
        return [placed(np.array([0, 0]), np.array([1, 1]), None)]
    corner, end = low[used].min(axis=0), high[used].max(axis=0) + 1
    if np.all(end - corner <= most):
        return [placed(corner, end, None)]
    strides = np.where(end - corner <= most, most, most - reach.span)
    cells = (low - corner) // strides
    found = []
    for cell in np.unique(cells[used], axis=0):
        begin = corner + cell * strides
        found.append(placed(begin, np.minimum(begin + most, end), used & np.all(cells == cell, axis=-1)))
    return found


def pair(values: NDArray[np.int64]) -> tuple[int, int]:
    """Return two values as Python integers."""
    return int(values[0]), int(values[1])


def ends(motion: Motion, first: Corner, reach: Reach) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the first and the last row and column that these pixels can read, by their least and greatest motion."""
    along = motion[..., 1], motion[..., 0]
    whole = (
        known(np.array([each.min() for each in along]), unknown=-FAR),
        known(np.array([each.max() for each in along]), unknown=FAR),
    )
    last = np.array(first) + motion.shape[:2] - 1
    return first + whole[0] - reach.below, last + whole[1] + reach.above


def taps_of(
    motion: Motion, first: Corner, shape: Shape, reach: Reach
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.bool_]]:
    """Return the first and the last row and column that each pixel reads in the image, and whether it reads any."""
    sides = np.array(shape)
    place = np.moveaxis(np.indices(motion.shape[:2]), 0, -1) + first + known(motion[..., 1::-1])
    low, high = place - reach.below, place + reach.above
    used = np.isfinite(motion).all(axis=-1) & np.all((high >= 0) & (low < sides), axis=-1)
    return np.clip(low, 0, sides - 1), np.clip(high, 0, sides - 1), used


def known(motion: NDArray[np.float32], unknown: float = FAR) -> NDArray[np.int64]:
    """Return motion in whole pixels, rounded down; NaN becomes `unknown`."""
    return np.floor(np.clip(np.nan_to_num(motion, nan=unknown), -FAR, FAR)).astype(np.int64)
