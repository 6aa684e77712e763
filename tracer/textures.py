"""All textures of a scene in one array, so that a batch of rays reads any number of them in one gather."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from .vectors import Float32

Image = NDArray[np.uint8]


def srgb_to_linear(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Decode sRGB values in 0..1 to linear ones (IEC 61966-2-1)."""
    return np.where(values <= 0.04045, values / 12.92, ((values + 0.055) / 1.055) ** 2.4)


# Linear value of every 8-bit sRGB code.
LINEAR = srgb_to_linear(np.arange(256) / 255.0).astype(np.float32)


class Textures:
    """sRGB images (h, w, 3) uint8, row 0 on top, read with bilinear filtering and repeat wrap.

    A texel is kept as one packed uint32, red lowest: a quarter of the memory of linear floats, and one gather.
    """

    def __init__(self, images: Sequence[Image]) -> None:
        packed = [(image.astype(np.uint32) << np.array([0, 8, 16], np.uint32)).sum(2, np.uint32) for image in images]
        self._heights = np.array([image.shape[0] for image in images], np.int32)
        self._widths = np.array([image.shape[1] for image in images], np.int32)
        self._starts = np.cumsum([0, *(image.size for image in packed)])[:-1]
        self._texels = np.concatenate([image.ravel() for image in packed]) if images else np.empty(0, np.uint32)

    def sample(self, texture: NDArray[np.int32], uv: Float32) -> Float32:
        """Linear colour (3, N) of textures `texture` (N,) at `uv` (2, N); v points up, as in trimesh."""
        width, height = self._widths.take(texture), self._heights.take(texture)
        start = self._starts.take(texture)
        left, right, fx = _neighbours(uv[0], width)
        upper, lower, fy = _neighbours(1 - uv[1], height)
        upper, lower = start + upper * width, start + lower * width
        top = _mix(self._texels.take(upper + left), self._texels.take(upper + right), fx)
        top += fy * (_mix(self._texels.take(lower + left), self._texels.take(lower + right), fx) - top)
        return top


def _neighbours(coordinate: Float32, size: NDArray[np.int32]) -> tuple[NDArray[np.int32], NDArray[np.int32], Float32]:
    """The two texels of one axis around a repeating texture `coordinate`, and the weight of the second."""
    position = coordinate - np.floor(coordinate)
    position *= size
    position -= np.float32(0.5)
    floor = np.floor(position)
    first = floor.astype(np.int32)
    return first % size, (first + 1) % size, position - floor


def _mix(first: NDArray[np.uint32], second: NDArray[np.uint32], weight: Float32) -> Float32:
    """Decode two batches of packed texels and interpolate between them: (3, N)."""
    result = np.empty((3, len(weight)), np.float32)
    for channel in range(3):
        a = LINEAR.take((first >> (8 * channel)) & 255)
        result[channel] = a + weight * (LINEAR.take((second >> (8 * channel)) & 255) - a)
    return result
