"""Bounding boxes, to skip rays that miss everything; this takes a tenth of the time that Embree needs for such rays."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from .compiled import compiled
from .vectors import Float32, Float64

TINY = 1e-30

# The box of an object that may be anywhere.
EVERYWHERE = np.array([[-np.inf] * 3, [np.inf] * 3])


def bounds(points: NDArray[np.floating]) -> Float64:
    """The box (2, 3), its lowest and highest corner, around `points` (..., 3)."""
    flat = points.reshape(-1, 3)
    return np.array([flat.min(0), flat.max(0)], np.float64)


def corners_of_box(box: Float64) -> Float64:
    """The eight corners (8, 3) of a box (2, 3)."""
    return np.stack(np.meshgrid(*box.T), axis=-1).reshape(-1, 3)


def passing(boxes: Iterable[Float64], origin: Float32, direction: Float32, distance: Float32) -> NDArray[np.bool_]:
    """Which rays from `origin` (N, 3) along `direction` (N, 3) pass any of the boxes (2, 3) within `distance` (N,)."""
    passes = np.zeros(len(origin), np.bool_)
    for box in boxes:
        # The box is enlarged a little: rounding must not lose rays that run along a face of the box.
        room = 1e-5 * np.abs(box).max()
        _mark(box[0] - room, box[1] + room, origin, direction, distance, passes)
    return passes


@compiled
def _mark(
    low: Float64, high: Float64, origin: Float32, direction: Float32, distance: Float32, passes: NDArray[np.bool_]
) -> None:
    """Mark the rays that pass one box; without branches, for vectors."""
    for ray in range(len(origin)):
        # Along a face of the box, 0 / 0 would compare as neither in front of the face nor behind it.
        x = 1.0 / (direction[ray, 0] + TINY)
        y = 1.0 / (direction[ray, 1] + TINY)
        z = 1.0 / (direction[ray, 2] + TINY)
        x1, x2 = (low[0] - origin[ray, 0]) * x, (high[0] - origin[ray, 0]) * x
        y1, y2 = (low[1] - origin[ray, 1]) * y, (high[1] - origin[ray, 1]) * y
        z1, z2 = (low[2] - origin[ray, 2]) * z, (high[2] - origin[ray, 2]) * z
        enters = max(max(min(x1, x2), min(y1, y2)), max(min(z1, z2), 0.0))
        leaves = min(min(max(x1, x2), max(y1, y2)), min(max(z1, z2), distance[ray]))
        passes[ray] |= enters <= leaves
