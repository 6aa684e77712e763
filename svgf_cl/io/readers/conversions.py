"""Converts passes that several renderers write in the same way to fields of `Frame`."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[Any]

FAR = 1e9  # a greater depth means that the ray hit nothing


def depth_of_hits(depth: Array) -> Array:
    """Return depth (H, W) with infinity where nothing was hit; renderers write 0 or a great number there."""
    return np.where((depth > 0) & (depth < FAR), depth, np.float32(np.inf))


def reflected(albedo: Array) -> Array:
    """Return albedo (H, W, 3), limited to 1, from a pass that has emitted light where a lamp is visible."""
    limited: Array = np.minimum(albedo[..., :3], np.float32(1))
    return limited


def y_down(vector: Array) -> Array:
    """Return the motion to the previous frame, (H, W, 2), y down, from previous minus current position, y up."""
    moved: Array = vector[..., :2] * np.array([1, -1], np.float32)
    return moved


def against_time(vector: Array) -> Array:
    """Return the motion to the previous frame, (H, W, 2), y down, from the movement during a frame, y up."""
    return -y_down(vector)


def along_time(vector: Array) -> Array:
    """Return the motion to the next frame, (H, W, 2), y down, from the movement during a frame, y up."""
    return y_down(vector)


def without_edges(ids: Array) -> Array:
    """Return ids (H, W) from an antialiased pass: a pixel at an edge has a mean of ids, and gets a neighbour's id."""
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
    """Return the ids (H, W) from the first layer (H, W, 4) of a Cryptomatte: the bits of its first component."""
    return np.ascontiguousarray(cryptomatte[..., 0], np.float32).view(np.uint32)
