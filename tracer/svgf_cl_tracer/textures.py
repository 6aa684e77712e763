"""All textures of a scene in one array, and their look-up in compiled loops."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .compiled import compiled
from .vec3 import Vec3
from .vectors import Float32

Image = NDArray[np.uint8]


def srgb_to_linear(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Decode sRGB values in 0..1 to linear ones (IEC 61966-2-1)."""
    return np.where(values <= 0.04045, values / 12.92, ((values + 0.055) / 1.055) ** 2.4)


# The linear value of every 8-bit sRGB code.
LINEAR = srgb_to_linear(np.arange(256) / 255.0).astype(np.float32)


class Textures(NamedTuple):
    """sRGB images, row 0 on top, read with bilinear filtering and repeated at their edges.

    A texel is one packed uint32, with red in the lowest bits and opacity in the highest: a quarter of the memory of
    floats.
    """

    texels: NDArray[np.uint32]
    starts: NDArray[np.int64]
    widths: NDArray[np.int64]
    heights: NDArray[np.int64]
    linear: Float32

    @classmethod
    def of(cls, images: Sequence[Image]) -> Textures:
        """Pack images (h, w, 3) or, with opacity, (h, w, 4) uint8."""
        packed = [_pack(image).ravel() for image in images]
        return cls(
            np.concatenate([*packed, np.zeros(0, np.uint32)]),
            np.cumsum([0, *(len(texels) for texels in packed)])[:-1].astype(np.int64),
            np.array([image.shape[1] for image in images], np.int64),
            np.array([image.shape[0] for image in images], np.int64),
            LINEAR,
        )


def _pack(image: Image) -> NDArray[np.uint32]:
    channels = np.full((*image.shape[:2], 4), 255, np.uint8)
    channels[..., : image.shape[2]] = image
    return channels.view("<u4")[..., 0]


@compiled
def texture_colour(textures: Textures, texture: int, u: float, v: float) -> Vec3:
    """Linear colour of a texture at (u, v); v points up."""
    first, second, third, fourth, fx, fy = _texels(textures, texture, u, v)
    linear = textures.linear
    red = _mix(linear[first & 255], linear[second & 255], linear[third & 255], linear[fourth & 255], fx, fy)
    first, second, third, fourth = first >> 8, second >> 8, third >> 8, fourth >> 8
    green = _mix(linear[first & 255], linear[second & 255], linear[third & 255], linear[fourth & 255], fx, fy)
    first, second, third, fourth = first >> 8, second >> 8, third >> 8, fourth >> 8
    blue = _mix(linear[first & 255], linear[second & 255], linear[third & 255], linear[fourth & 255], fx, fy)
    return red, green, blue


@compiled
def texture_opacity(textures: Textures, texture: int, u: float, v: float) -> float:
    """Opacity of a texture at (u, v), 0..1."""
    first, second, third, fourth, fx, fy = _texels(textures, texture, u, v)
    # As floats, because differences of unsigned numbers cannot be negative.
    upper = np.float64(first >> 24), np.float64(second >> 24)
    lower = np.float64(third >> 24), np.float64(fourth >> 24)
    return _mix(*upper, *lower, fx, fy) / 255.0


@compiled
def _texels(
    textures: Textures, texture: int, u: float, v: float
) -> tuple[np.uint32, np.uint32, np.uint32, np.uint32, float, float]:
    """The four texels around a point, upper left, upper right, lower left, lower right, and its place in between."""
    # NumPy's floor is one instruction, Python's is a call.
    width, height, start = textures.widths[texture], textures.heights[texture], textures.starts[texture]
    x, y = (u - np.floor(u)) * width - 0.5, (np.ceil(v) - v) * height - 0.5
    left, top = np.floor(x), np.floor(y)
    fx, fy = x - left, y - top
    # At most half a texel beyond an edge, so no division is needed.
    column, row = int(left), int(top)
    right, below = column + 1, row + 1
    if column < 0:
        column += width
    if row < 0:
        row += height
    if right >= width:
        right -= width
    if below >= height:
        below -= height
    upper, lower = start + row * width, start + below * width
    texels = textures.texels
    return texels[upper + column], texels[upper + right], texels[lower + column], texels[lower + right], fx, fy


@compiled
def _mix(first: float, second: float, third: float, fourth: float, fx: float, fy: float) -> float:
    top = first + fx * (second - first)
    bottom = third + fx * (fourth - third)
    return top + fy * (bottom - top)
