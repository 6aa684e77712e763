"""The data of a batch of paths: arrays that Embree and compiled loops pass to each other."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .camera import Lens
from .vectors import Float32

# Kinds of light: by how often it was reflected, and by which lobe of the first surface.
DIRECT_DIFFUSE, DIRECT_SPECULAR, INDIRECT_DIFFUSE, INDIRECT_SPECULAR, EMISSION = range(5)
DIFFUSE, SPECULAR = 0, 1


class Paths(NamedTuple):
    """N rays in progress.

    `pixel` is the index in the batch. `density` is the density of the direction per solid angle; 0 if no other sampling
    method can find what the ray hits. `lobe` is that of the first surface. `scatterings` is how many more times the
    path may be scattered.
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
    """Rays towards lights, and the light they bring by each lobe of the first surface if nothing is in between."""

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
        """The features of neighbouring pixels, which share memory."""
        return Features(*(values[pixels] for values in self))  # type: ignore[arg-type]  # each of its own type


class Radiance(NamedTuple):
    """Light of N pixels, (N, 3) each: ``color = direct + indirect + emission = diffuse + specular + emission``.

    Direct light was reflected once, indirect light more often; diffuse light was reflected by the diffuse lobe of the
    first surface.
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
        """The light of neighbouring pixels, which shares memory."""
        return Radiance(*(values[pixels] for values in self))


class Before(NamedTuple):
    """The previous frame, for motion: its camera, and the `corners` of the triangles that move.

    These triangles are numbered from `first` on.
    """

    lens: Lens
    first: int
    corners: Float32


class Aim(NamedTuple):
    """Where rays pass through an image `width` pixels wide: at the offset `x`, `y` from the pixel's centre.

    They are spread at random over a square around that point with the side `spread`, in pixels.
    """

    width: int
    x: float
    y: float
    spread: float


class Draws(NamedTuple):
    """The source of a batch's random numbers: a stream's key, the sample's number, and each pixel's number."""

    key: int
    sample: int
    pixels: NDArray[np.int64]
