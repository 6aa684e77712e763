"""Which parts of the previous frame a tile reads along motion, cut into windows that fit into a buffer."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from svgf_cl.filters.pipeline import Pass
from svgf_cl.frame import Shape

Motion = NDArray[np.float32]
Corner = tuple[int, int]  # row, column
FAR = 1e6  # pixels: motion out of every image, as in kernels/reprojection.clh


@dataclass(frozen=True)
class Reach:
    """How far a pass reads to either side of the whole pixel at or above and left of p + motion, in pixels."""

    below: int
    above: int
    beside: int  # from a pixel to that whose motion it goes by

    @classmethod
    def of(cls, entry: Pass) -> Reach:
        """That of a pass's taps along motion, whichever pixel beside it takes the motion from."""
        taps = [tap for each in entry.reads for tap in entry.taps(each) if tap.follow_motion]
        along = [distance for tap in taps for offset in tap.offsets for distance in offset]
        beside = max(entry.reach(each) for each in entry.reads if each.of == "motion")
        return cls(beside - min(along), beside + max(along), beside)

    @property
    def span(self) -> int:
        """Pixels beyond the first that are read along an axis."""
        return self.below + self.above


@dataclass(frozen=True, eq=False)
class PastWindow:
    """A window on the previous frame.

    Parameters
    ----------
    origin : (int, int)
        Row and column of the image where it begins; it lies inside the image.
    corner, size : (int, int)
        The part of the image that is read in it: its first row and column, its height and width.
    readers : (h, w) bool, optional
        The pixels whose motion leads there; None where that of all does that leads into the image.
    """

    origin: Corner
    corner: Corner
    size: Shape
    readers: NDArray[np.bool_] | None = None


def past_windows(motion: Motion, first: Corner, shape: Shape, window: Shape, reach: Reach) -> list[PastWindow]:
    """Windows of which every pixel's motion leads into one, with all the taps there that lie inside the image.

    One will do where motion is much the same all over. Motion that leads anywhere takes as many as the image has room
    for.

    Parameters
    ----------
    motion : (h, w, 2 or 3) float32
        Of pixels that lie together.
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
    if np.all(end - corner <= most):  # by the extremes of motion alone, which takes a fraction of the time
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
    """Two whole numbers."""
    return int(values[0]), int(values[1])


def ends(motion: Motion, first: Corner, reach: Reach) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """The first and the last row and column that these pixels may read, if each had the least and greatest motion."""
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
    """The first and the last row and column that each pixel reads in the image, and whether it reads there at all."""
    sides = np.array(shape)
    place = np.moveaxis(np.indices(motion.shape[:2]), 0, -1) + first + known(motion[..., 1::-1])
    low, high = place - reach.below, place + reach.above
    used = np.isfinite(motion).all(axis=-1) & np.all((high >= 0) & (low < sides), axis=-1)
    return np.clip(low, 0, sides - 1), np.clip(high, 0, sides - 1), used


def known(motion: NDArray[np.float32], unknown: float = FAR) -> NDArray[np.int64]:
    """Motion in whole pixels, rounded down; what is no number leads out of every image."""
    return np.floor(np.clip(np.nan_to_num(motion, nan=unknown), -FAR, FAR)).astype(np.int64)
