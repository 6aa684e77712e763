"""What a batch of paths is made of while it is traced: arrays that Embree and compiled loops hand to each other."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .camera import Lens
from .vectors import Float32

# What a path's light is counted as: how often it was reflected, and by which lobe of the first surface.
DIRECT_DIFFUSE, DIRECT_SPECULAR, INDIRECT_DIFFUSE, INDIRECT_SPECULAR, EMISSION = range(5)
DIFFUSE, SPECULAR = 0, 1


class Paths(NamedTuple):
    """Rays underway, N of them.

    `pixel` counts within the batch; `density` is that of the direction per solid angle, 0 where nothing but the path
    itself finds what it leads to; `lobe` is that of the first surface; `scatterings` are left to it.
    """

    origin: Float32
    direction: Float32
    throughput: Float32
    density: Float32
    pixel: NDArray[np.int32]
    lobe: NDArray[np.uint8]
    scatterings: NDArray[np.int32]

    @classmethod
    def empty(cls, count: int) -> Paths:
        """Room for `count` paths."""
        return cls(
            np.empty((count, 3), np.float32),
            np.empty((count, 3), np.float32),
            np.empty((count, 3), np.float32),
            np.empty(count, np.float32),
            np.empty(count, np.int32),
            np.empty(count, np.uint8),
            np.empty(count, np.int32),
        )

    def first(self, count: int) -> Paths:
        """The first `count` of them."""
        return Paths(*(values[:count] for values in self))  # type: ignore[arg-type]  # each of its own type


class ShadowRays(NamedTuple):
    """Rays towards lights, and what they bring by either lobe of the first surface if nothing is in between."""

    origin: Float32
    direction: Float32
    distance: Float32
    light: Float32
    pixel: NDArray[np.int32]

    @classmethod
    def empty(cls, count: int) -> ShadowRays:
        """Room for `count` rays."""
        rays = np.empty((count, 3), np.float32), np.empty((count, 3), np.float32), np.empty(count, np.float32)
        return cls(*rays, np.empty((count, 2, 3), np.float32), np.empty(count, np.int32))

    def first(self, count: int) -> ShadowRays:
        """The first `count` of them."""
        return ShadowRays(*(values[:count] for values in self))  # type: ignore[arg-type]  # each of its own type


class Features(NamedTuple):
    """The G-buffer of N pixels: fields of `svgf_cl.Frame`, (N, C) or (N,)."""

    albedo: Float32
    normal: Float32
    depth: Float32
    motion: Float32
    id: NDArray[np.uint32]
    roughness: Float32
    hit_distance: Float32

    @classmethod
    def empty(cls, count: int) -> Features:
        """Room for `count` pixels."""
        return cls(
            np.empty((count, 3), np.float32),
            np.empty((count, 3), np.float32),
            np.empty(count, np.float32),
            np.empty((count, 3), np.float32),
            np.empty(count, np.uint32),
            np.empty(count, np.float32),
            np.empty((count, 2), np.float32),
        )

    def part(self, pixels: slice) -> Features:
        """Those of some neighbouring pixels, which share memory."""
        return Features(*(values[pixels] for values in self))  # type: ignore[arg-type]  # each of its own type


class Radiance(NamedTuple):
    """Light of N pixels, (N, 3) each: ``color = direct + indirect + emission = diffuse + specular + emission``.

    Direct light was reflected once, indirect light more often; diffuse light by the diffuse lobe of the first surface.
    """

    color: Float32
    direct: Float32
    indirect: Float32
    diffuse: Float32
    specular: Float32
    emission: Float32

    @classmethod
    def empty(cls, count: int) -> Radiance:
        """Room for `count` pixels."""
        return cls(*(np.empty((count, 3), np.float32) for _ in cls._fields))

    def part(self, pixels: slice) -> Radiance:
        """That of some neighbouring pixels, which shares memory."""
        return Radiance(*(values[pixels] for values in self))


class Before(NamedTuple):
    """What motion is measured from: the camera of one frame earlier, and the `corners` of the triangles that move.

    Those are numbered from `first` on.
    """

    lens: Lens
    first: int
    corners: Float32


class Aim(NamedTuple):
    """Where rays go through an image `width` pixels wide: off the pixel's centre by `x`, `y`.

    They are spread at random over a square of side `spread` around that, in pixels.
    """

    width: int
    x: float
    y: float
    spread: float


class Draws(NamedTuple):
    """Where a batch's random numbers come from: a stream's key, the number of the sample, each pixel's number."""

    key: int
    sample: int
    pixels: NDArray[np.int64]
