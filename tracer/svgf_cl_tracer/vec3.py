"""Vectors and colours inside compiled loops: plain tuples of three floats, which stay in registers."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from svgf_cl.frame import LUMINANCE

from .compiled import compiled

Vec3 = tuple[float, float, float]


@compiled
def row(rows: NDArray[Any], index: int) -> Vec3:
    """Row `index` of an array (N, 3), in double precision."""
    # Not float(), because Numba would keep a float32.
    return np.float64(rows[index, 0]), np.float64(rows[index, 1]), np.float64(rows[index, 2])


@compiled
def dot(a: Vec3, b: Vec3) -> float:
    """The dot product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@compiled
def cross(a: Vec3, b: Vec3) -> Vec3:
    """The cross product."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@compiled
def add(a: Vec3, b: Vec3) -> Vec3:
    """The sum."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


@compiled
def subtract(a: Vec3, b: Vec3) -> Vec3:
    """The difference."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@compiled
def multiply(a: Vec3, b: Vec3) -> Vec3:
    """The product of each component."""
    return a[0] * b[0], a[1] * b[1], a[2] * b[2]


@compiled
def scale(a: Vec3, factor: float) -> Vec3:
    """A vector `factor` times as long."""
    return a[0] * factor, a[1] * factor, a[2] * factor


@compiled
def normalise(a: Vec3) -> Vec3:
    """The vector with length 1; a vector of length 0 is unchanged."""
    length = math.sqrt(dot(a, a))
    return scale(a, 1.0 / length) if length > 0.0 else a


@compiled
def luminance(colour: Vec3) -> float:
    """Rec. 709 luminance of a linear colour."""
    return dot(LUMINANCE, colour)


@compiled
def tangents(normal: Vec3) -> tuple[Vec3, Vec3]:
    """Two unit vectors that make a right-handed frame with the unit vector `normal`.

    Source: Duff et al., Building an Orthonormal Basis, Revisited, JCGT 6 (1), 2017, listing 3.
    """
    x, y, z = normal
    sign = math.copysign(1.0, z)
    a = -1.0 / (sign + z)
    b = x * y * a
    return (1.0 + sign * x * x * a, sign * b, -sign * x), (b, sign + y * y * a, -y)


@compiled
def to_world(local: Vec3, normal: Vec3) -> Vec3:
    """A vector in the frame whose third axis is `normal`, converted to the world."""
    tangent, bitangent = tangents(normal)
    return add(add(scale(tangent, local[0]), scale(bitangent, local[1])), scale(normal, local[2]))


@compiled
def to_local(world: Vec3, normal: Vec3) -> Vec3:
    """The inverse of `to_world`."""
    tangent, bitangent = tangents(normal)
    return dot(world, tangent), dot(world, bitangent), dot(world, normal)
