"""Random numbers and the two distributions the tracer draws from."""

from __future__ import annotations

import numpy as np

from .vectors import Float32

JITTER_PERIOD = 16


def halton(index: int, base: int) -> float:
    """Element `index` (from 1) of the van der Corput sequence of `base`, in (0, 1)."""
    value, digit = 0.0, 1.0
    while index:
        digit /= base
        index, remainder = divmod(index, base)
        value += digit * remainder
    return value


def pixel_jitter(frame_index: int) -> tuple[float, float]:
    """Sub-pixel offset (x, y) of a frame, each in (-0.5, 0.5): Halton (2, 3), looped after `JITTER_PERIOD` frames."""
    index = frame_index % JITTER_PERIOD + 1
    return halton(index, 2) - 0.5, halton(index, 3) - 0.5


def random_stream(*key: int) -> np.random.Generator:
    """A generator of its own for each `key` of non-negative integers, whichever thread asks for it."""
    return np.random.default_rng(key)


def sphere_directions(u: Float32) -> Float32:
    """Uniform directions (3, N) on the unit sphere from uniform numbers `u` (2, N) in [0, 1)."""
    directions = np.empty((3, u.shape[1]), np.float32)
    z = np.subtract(1, 2 * u[0], out=directions[2])
    radius = np.sqrt(1 - z * z)
    angle = u[1] * np.float32(2 * np.pi)
    np.multiply(radius, np.cos(angle), out=directions[0])
    np.multiply(radius, np.sin(angle), out=directions[1])
    return directions


def cosine_directions(normal: Float32, u: Float32) -> Float32:
    """Directions (3, N) around `normal` (3, N) with density cos(angle) / pi, from `u` (2, N) in [0, 1).

    Their lengths vary: the tip lies on the sphere of radius 1 around the tip of the normal, which needs neither a
    tangent frame nor a square root.
    """
    directions = sphere_directions(u)
    directions += normal
    return directions


def triangle_coordinates(u: Float32) -> tuple[Float32, Float32]:
    """Barycentric coordinates (N,), (N,) of the second and third corner, uniform over a triangle, from `u` (2, N)."""
    root = np.sqrt(u[0])
    second = 1 - root
    return second, u[1] * root
