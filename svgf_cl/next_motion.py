"""Computes the motion to the next frame, which a backward run needs, from the motion to the previous frame.

Equations: docs/algorithm.md, section 9.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from svgf_cl.check.view import is_hit, over_channels
from svgf_cl.errors import FrameError
from svgf_cl.frame import Frame, Shape

Plane = NDArray[np.float32]
Mask = NDArray[np.bool_]
Whole = NDArray[np.int64]

# Greatest difference from the expected depth, relative to depth, in addition to the slope: the same as the filters'
# default `depth_threshold`. Filters test again by their own threshold.
DEPTH_TOLERANCE = 0.02
CORNERS = ((0, 0), (1, 0), (0, 1), (1, 1))  # dx, dy of the four pixels around a point


def motion_to_next(frame: Frame, following: Frame) -> Plane:
    """Return the motion from a frame to the following one.

    Each pixel of the following frame came from a point between four pixels of this frame. Its motion, reversed, counts
    for those of the four that show the same surface: they have the same id, if both frames have ids, and the expected
    depth.

    Parameters
    ----------
    frame, following : Frame
        Two consecutive frames of one size with numpy arrays. Only the motion of `following` is read.

    Returns
    -------
    (H, W, 2) or (H, W, 3) float32, as the motion of `following`
        Next minus current position in pixels: ``p_next = p + motion``. A third component is the expected next depth
        minus the current depth. It is NaN, which means no history, where the following frame does not show the pixel's
        surface.

    Raises
    ------
    FrameError
        If a field is not a numpy array, or the frames have different sizes.

    Examples
    --------
    >>> backward = replace(frame, motion=motion_to_next(frame, following))
    """
    for each in (frame, following):
        check_on_host(each)
    following.check(frame.shape)
    surface, points = Surface.of(frame), Points.of(following)
    total, weights = np.zeros((len(points.motion), surface.size)), np.zeros(surface.size)
    for dx, dy in CORNERS:
        place = points.place + (dy * surface.shape[1] + dx)
        weight = points.weight(dx, dy) * surface.shows(points, place)
        weights += np.bincount(place, weight, surface.size)
        for sums, component in zip(total, points.motion, strict=True):
            sums += np.bincount(place, weight * component, surface.size)
    with np.errstate(invalid="ignore"):
        return surface.inside(-total / weights)  # 0 / 0 is NaN


def check_on_host(frame: Frame) -> None:
    """Raise `FrameError` unless the fields are numpy arrays that match each other."""
    for name, value in frame.present().items():
        if not isinstance(value, np.ndarray):
            raise FrameError(name, "a numpy.ndarray, because this is computed on the host", type(value).__name__)
    frame.check(frame.shape)


@dataclass(frozen=True, eq=False)
class Surface:
    """The surfaces of a frame, as flat arrays of (H + 2) (W + 2) pixels with an empty border.

    Parameters
    ----------
    shape : (int, int)
        (height, width) with the border.
    nearest, farthest : (n,)
        A point between these depths belongs to the pixel's surface; both are 0 where nothing was hit.
    id : (n,), optional
    """

    shape: Shape
    nearest: Plane
    farthest: Plane
    id: NDArray[np.integer] | None

    @classmethod
    def of(cls, frame: Frame) -> Surface:
        """Return the surfaces of `frame`."""
        depth = known_depth(frame)
        tolerance = DEPTH_TOLERANCE * depth + 2 * slope(depth)
        return cls(
            (depth.shape[0] + 2, depth.shape[1] + 2),
            np.pad(depth - tolerance, 1, constant_values=np.inf).ravel(),
            np.pad(depth + tolerance, 1, constant_values=-np.inf).ravel(),
            None if frame.id is None else np.pad(frame.id, 1).ravel(),
        )

    @property
    def size(self) -> int:
        """Number of pixels."""
        return self.shape[0] * self.shape[1]

    def shows(self, points: Points, place: Whole) -> Mask:
        """Return whether the pixel at its place (m,) shows each point, (m,)."""
        shown: Mask = (self.nearest[place] <= points.depth) & (points.depth <= self.farthest[place])
        if self.id is not None and points.id is not None:
            shown &= self.id[place] == points.id
        return shown

    def inside(self, values: NDArray[np.float64]) -> Plane:
        """Return (C, n) as (H, W, C), without the border."""
        picture = values.reshape(-1, *self.shape)[:, 1:-1, 1:-1]
        return np.ascontiguousarray(np.moveaxis(picture, 0, -1), np.float32)


@dataclass(frozen=True, eq=False)
class Points:
    """The positions of a frame's pixels in the previous frame, for pixels that have motion and were in the picture.

    Parameters
    ----------
    place : (m,)
        The pixel above and left of each point, as an index into a `Surface`.
    right, down : (m,)
        The distance of each point from that pixel, 0..1.
    depth : (m,)
        The depth that is expected there; 0 where nothing was hit.
    motion : (2, m) or (3, m)
        The frame's motion, component by component.
    id : (m,), optional
    """

    place: Whole
    right: Plane
    down: Plane
    depth: Plane
    motion: Plane
    id: NDArray[np.integer] | None

    @classmethod
    def of(cls, frame: Frame) -> Points:
        """Return the points of the pixels of `frame`."""
        height, width = frame.shape
        motion = np.asarray(frame.motion, np.float32)
        x = np.arange(width, dtype=np.float32) + motion[..., 0]
        y = np.arange(height, dtype=np.float32)[:, None] + motion[..., 1]
        known = over_channels(np.logical_and, np.isfinite(motion)) & (x > -1) & (x < width) & (y > -1) & (y < height)
        x, y, depth = x[known], y[known], known_depth(frame)[known]
        components = np.stack([component[known] for component in np.moveaxis(motion, -1, 0)])
        if len(components) == 3:
            depth = np.where(depth > 0, depth + components[2], 0)
        left, top = np.floor(x), np.floor(y)
        place = (top.astype(np.int64) + 1) * (width + 2) + left.astype(np.int64) + 1
        return cls(place, x - left, y - top, depth, components, None if frame.id is None else frame.id[known])

    def weight(self, dx: int, dy: int) -> Plane:
        """Return the bilinear weight of the pixel (dx, dy) from `place`, (m,)."""
        weight: Plane = (self.right if dx else 1 - self.right) * (self.down if dy else 1 - self.down)
        return weight


def known_depth(frame: Frame) -> Plane:
    """Return depth, (H, W), with 0 where nothing was hit."""
    return np.where(is_hit(frame.depth, frame.normal), frame.depth, 0).astype(np.float32)


def slope(depth: Plane) -> Plane:
    """Return the change of depth to the neighbour in the row, plus that in the column, (H, W).

    The more similar of both neighbours counts, as the other may lie across an edge.
    """
    known = np.pad(np.where(depth > 0, depth, np.nan), 1, constant_values=np.nan)
    across, along = np.abs(np.diff(known[1:-1], axis=1)), np.abs(np.diff(known[:, 1:-1], axis=0))
    sides = np.fmin(across[:, :-1], across[:, 1:]), np.fmin(along[:-1], along[1:])
    total: Plane = np.nan_to_num(sides[0]) + np.nan_to_num(sides[1])
    return total
