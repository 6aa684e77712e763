"""Array helpers of the oracle: luminance, positions of taps, and the depth gradient.

Pixel centres are at whole coordinates; offsets and positions are (x, y), array indices are [y, x].
"""

from __future__ import annotations

import functools

import numpy as np
from numpy.typing import NDArray

from svgf_cl.frame import LUMINANCE, Shape

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
Indices = NDArray[np.int64]
Offset = tuple[int, int]

GAUSSIAN = {-1: 1 / 4, 0: 1 / 2, 1: 1 / 4}


def luminance(color: Array) -> Array:
    """Rec. 709 luminance, l(): (..., 3) to (...)."""
    luma: Array = color @ np.array(LUMINANCE)
    return luma


def finite(color: Array) -> Mask:
    """Where all channels are finite: (..., 3) to (..., 1)."""
    mask: Mask = np.asarray(np.isfinite(color).all(axis=-1, keepdims=True))
    return mask


def dot(a: Array, b: Array) -> Array:
    """Inner product over the last axis."""
    product: Array = np.einsum("...i,...i->...", a, b)
    return product


def square(radius: int) -> list[Offset]:
    """Offsets (dx, dy) of the (2 radius + 1)^2 taps around a pixel."""
    reach = range(-radius, radius + 1)
    return [(dx, dy) for dy in reach for dx in reach]


def window(radius: int, shape: Shape) -> list[Offset]:
    """The taps of `square` that are inside an image for any of its pixels, without the centre."""
    height, width = shape
    return [(dx, dy) for dx, dy in square(radius) if (dx or dy) and abs(dx) < width and abs(dy) < height]


def locate(x: Indices, y: Indices, shape: Shape) -> tuple[Indices, Indices, Mask]:
    """Rows and columns clamped into an image, and whether they were inside it."""
    height, width = shape
    rows, columns = np.clip(y, 0, height - 1), np.clip(x, 0, width - 1)
    return rows, columns, (rows == y) & (columns == x)


def shifted(offset: Offset, shape: Shape, step: int = 1) -> tuple[Indices, Indices, Mask]:
    """`locate` the tap p + step * offset of every pixel: rows (H, 1), columns (1, W), inside (H, W)."""
    columns, inside_x = _moved(step * offset[0], shape[1])
    rows, inside_y = _moved(step * offset[1], shape[0])
    return rows[:, None], columns[None], inside_y[:, None] & inside_x


@functools.lru_cache(maxsize=1024)
def _moved(distance: int, length: int) -> tuple[Indices, Mask]:
    """The indices 0 .. length - 1 moved along their axis and clamped to it, and whether they were on it: (length,)."""
    moved = np.arange(length) + distance
    return np.clip(moved, 0, length - 1), (moved >= 0) & (moved < length)


def reprojected(motion: Array) -> Array:
    """Position in the previous frame, p' = p + m_xy: (H, W, 2)."""
    y, x = np.indices(motion.shape[:2])
    return np.stack((x, y), axis=-1) + motion[..., :2]


def bilinear_taps(position: Array) -> tuple[Indices, Indices, Array]:
    """Find the 2x2 footprint of `position` (H, W, 2): x, y and bilinear weight of its taps, each (4, H, W)."""
    corner = np.floor(position)
    x, y = np.moveaxis(np.stack([corner + np.array((dx, dy)) for dy in (0, 1) for dx in (0, 1)]), -1, 0)
    weight = (1 - np.abs(position[..., 0] - x)) * (1 - np.abs(position[..., 1] - y))
    return x.astype(np.int64), y.astype(np.int64), weight


def catmull_rom_taps(position: Array) -> tuple[Indices, Indices, Array]:
    """Find the 4x4 footprint of `position` (H, W, 2): x, y and Catmull-Rom weight of its taps, each (16, H, W)."""
    corner = np.floor(position).astype(np.int64)
    offsets = [(dx, dy) for dy in range(-1, 3) for dx in range(-1, 3)]
    x, y = np.moveaxis(np.stack([corner + offset for offset in offsets]), -1, 0)
    return x, y, catmull_rom(position[..., 0] - x) * catmull_rom(position[..., 1] - y)


def catmull_rom(distance: Array) -> Array:
    """Catmull and Rom's cardinal spline with tension 1/2 at a distance of up to 2, as in Keys 1981 with a = -1/2."""
    d = np.abs(distance)
    near = 1.5 * d**3 - 2.5 * d**2 + 1
    far = -0.5 * d**3 + 2.5 * d**2 - 4 * d + 2
    return np.where(d <= 1, near, np.where(d <= 2, far, 0))


def nearest_taps(position: Array) -> tuple[Indices, Indices, Array]:
    """Find the 3x3 taps around the pixel nearest to `position` (H, W, 2), with equal weights: each (9, H, W)."""
    centre = np.floor(position + 0.5).astype(np.int64)
    x, y = np.moveaxis(np.stack([centre + offset for offset in square(1)]), -1, 0)
    return x, y, np.ones(x.shape)


def depth_gradient(depth: Array) -> Array:
    """g, section 1: the smaller of the forward and the backward difference between hits along each axis, (H, W, 2)."""
    return np.stack((slope_along((1, 0), depth), slope_along((0, 1), depth)), axis=-1)


def slope_along(axis: Offset, depth: Array) -> Array:
    """One component of g, (H, W)."""
    ahead = difference(axis, depth)
    behind = -difference((-axis[0], -axis[1]), depth)
    forward = np.where(np.isfinite(ahead), ahead, behind)
    backward = np.where(np.isfinite(behind), behind, ahead)
    smaller = np.where(np.abs(forward) <= np.abs(backward), forward, backward)
    return np.where(np.isfinite(smaller) & (forward * backward > 0), smaller, 0)


def difference(offset: Offset, depth: Array) -> Array:
    """z(p + offset) - z(p) between two hits inside the image, otherwise infinite, (H, W)."""
    y, x, inside = shifted(offset, depth.shape)
    return np.where(inside & (depth > 0) & (depth[y, x] > 0), depth[y, x] - depth, np.inf)


def smoothed(variance: Array, hit: Mask) -> Array:
    """G, section 4: 3x3 Gaussian of a variance (S, H, W) over hits (H, W), divided by the sum of its weights."""
    total, weight = np.zeros_like(variance), np.zeros(hit.shape)
    for dx, dy in square(1):
        y, x, inside = shifted((dx, dy), hit.shape)
        w = GAUSSIAN[dx] * GAUSSIAN[dy] * (inside & hit[y, x])
        total += w * variance[:, y, x]
        weight += w
    return total / np.where(weight > 0, weight, 1)
