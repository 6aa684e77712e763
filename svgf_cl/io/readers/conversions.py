"""What makes fields of `Frame` of passes that several renderers write alike."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[Any]

FAR = 1e9  # depths beyond it stand for a ray that hit nothing


def depth_of_hits(depth: Array) -> Array:
    """Depth (H, W), infinite where nothing was hit: there renderers write 0, or a great number."""
    return np.where((depth > 0) & (depth < FAR), depth, np.float32(np.inf))


def reflected(albedo: Array) -> Array:
    """Albedo (H, W, 3) of passes that hold the light of lamps where lamps are seen: it is 1 there."""
    limited: Array = np.minimum(albedo[..., :3], np.float32(1))
    return limited


def y_down(vector: Array) -> Array:
    """The motion to the previous frame, (H, W, 2), y down, of previous minus current position, y up."""
    moved: Array = vector[..., :2] * np.array([1, -1], np.float32)
    return moved


def against_time(vector: Array) -> Array:
    """The motion to the previous frame, (H, W, 2), y down, of the way made during a frame, y up."""
    return -y_down(vector)


def along_time(vector: Array) -> Array:
    """The motion to the next frame, (H, W, 2), y down, of the way made during a frame, y up."""
    return y_down(vector)


def without_edges(ids: Array) -> Array:
    """Ids (H, W) of an antialiased pass, where a pixel at an edge holds a mean of ids: it gets a neighbour's."""
    values = np.asarray(ids, np.float64)
    whole = (values == np.floor(values)) & (values >= 0) & (values < 2**32)
    result = np.where(whole, values, 0)
    if not whole.all():
        padded = np.pad(result, 1)
        height, width = values.shape
        near = [padded[y : y + height, x : x + width] for y in range(3) for x in range(3)]
        result = np.where(whole, result, np.max(near, axis=0))
    return result.astype(np.uint32)


def hashes(cryptomatte: Array) -> Array:
    """The ids (H, W) in the first layer (H, W, 4) of a Cryptomatte: the bits of the first of its numbers."""
    return np.ascontiguousarray(cryptomatte[..., 0], np.float32).view(np.uint32)
