"""Light reflected by a rough surface: its directional albedo, tabulated when the module is imported.

A GGX lobe of width alpha with Schlick's Fresnel reflectance, seen under the cosine c, reflects the share f0 * scale(c,
alpha) + bias(c, alpha) of the light (Karis, Real Shading in Unreal Engine 4, 2013). The rest of the light, 1 - scale -
bias, has hit the surface a second time. A model of single scattering loses it; `bsdf` adds it again.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from .compiled import compiled
from .vectors import Float64

# The narrowest lobe. It blurs a reflection by about 2 * alpha: less than a pixel if 3840 pixels show 60 degrees, so it
# looks like a mirror. But it is a lobe, so that all surfaces are sampled and weighted in the same way.
ALPHA_FLOOR = 1e-4

# The nodes are even in the fourth root of the cosine (from 0 to 1), because the albedo bends where the cosine is about
# alpha, and even in the root of alpha (from FIRST to 1), which is the perceptual roughness.
COSINES, ALPHAS = 64, 64
FIRST = math.sqrt(ALPHA_FLOOR)
# Points along each axis for the integral over the visible normals.
POINTS = 16


class Terms(NamedTuple):
    """Two of the three shares of the light; the third one, `scale`, is 1 - lost - bias."""

    lost: float
    bias: float


def _integrate(cosine: Float64, alpha: Float64) -> tuple[Float64, Float64]:
    """`lost` and `bias` for arrays of one shape, by the midpoint rule over the visible normals.

    The normals are those of `bsdf.sample_specular`. With them, the integrand is only the ratio of the Smith shadowing
    with and without masking.
    """
    middle = (np.arange(POINTS) + 0.5) / POINTS
    # Points are dense near u = 1, the tail of the lobe, where light is lost. One side of the plane of incidence is
    # enough.
    u, weight, azimuth = 1.0 - middle[:, None] ** 2, 2.0 * middle[:, None], np.pi * middle
    c, a = cosine[..., None, None], alpha[..., None, None]
    sine = np.sqrt(1.0 - c * c)
    length = np.hypot(a * sine, c)
    x, z = a * sine / length, c / length
    cap = 1.0 - u * (1.0 + z)
    radius = np.sqrt(np.maximum(1.0 - cap * cap, 0.0))
    normal = np.stack(np.broadcast_arrays(a * (radius * np.cos(azimuth) + x), a * radius * np.sin(azimuth), cap + z))
    normal /= np.sqrt((normal * normal).sum(0))
    half = sine * normal[0] + c * normal[2]
    cosine_in = np.maximum(2.0 * half * normal[2] - c, 0.0)
    smith = np.sqrt(c * c + (a * sine) ** 2)
    smith_in = np.sqrt(cosine_in * cosine_in + a * a * (1.0 - cosine_in * cosine_in))
    ratio = cosine_in * (c + smith) / (cosine_in * smith + c * smith_in)
    bias = ratio * (1.0 - half) ** 5
    return ((1.0 - ratio) * weight).mean((-2, -1)), (bias * weight).mean((-2, -1))


def _tabulate() -> tuple[Float64, Float64]:
    """The terms (ALPHAS, COSINES, 2), and their means over the projected hemisphere (ALPHAS, 2)."""
    roots = np.linspace(0.0, 1.0, COSINES)
    cosine, alpha = np.meshgrid(np.maximum(roots, 1e-3) ** 4, np.linspace(FIRST, 1.0, ALPHAS) ** 2)
    table = np.stack(_integrate(cosine, alpha), -1)
    # This is the mean of the interpolated table, so that exactly the lost light is added again.
    fine = (np.arange(1024) + 0.5) / 1024
    interpolated = np.array([[np.interp(fine, roots, row[:, k]) for k in range(2)] for row in table])
    return table, (interpolated * 8.0 * fine**7).mean(-1)


# Numba treats these as constants and compiles them into the code.
TERMS, MEANS = _tabulate()


@compiled
def terms(cosine: float, alpha: float) -> Terms:
    """The terms at `cosine`, which is clamped to 0..1, for a lobe of width `alpha` in ALPHA_FLOOR..1."""
    row, v = _node((math.sqrt(alpha) - FIRST) / (1.0 - FIRST), ALPHAS)
    column, u = _node(math.sqrt(math.sqrt(max(cosine, 0.0))), COSINES)
    return Terms(_bilinear(row, column, 0, u, v), _bilinear(row, column, 1, u, v))


@compiled
def mean_terms(alpha: float) -> Terms:
    """The mean of `terms` over the hemisphere, weighted by the cosine."""
    row, v = _node((math.sqrt(alpha) - FIRST) / (1.0 - FIRST), ALPHAS)
    lost = MEANS[row, 0] + v * (MEANS[row + 1, 0] - MEANS[row, 0])
    bias = MEANS[row, 1] + v * (MEANS[row + 1, 1] - MEANS[row, 1])
    return Terms(lost, bias)


@compiled
def _node(position: float, count: int) -> tuple[int, float]:
    """The node before `position` in 0..1 among `count` nodes, and the weight of the next node."""
    scaled = min(max(position, 0.0), 1.0) * (count - 1)
    node = min(int(scaled), count - 2)
    return node, scaled - node


@compiled
def _bilinear(row: int, column: int, term: int, u: float, v: float) -> float:
    upper: float = TERMS[row, column, term] + u * (TERMS[row, column + 1, term] - TERMS[row, column, term])
    lower: float = TERMS[row + 1, column, term] + u * (TERMS[row + 1, column + 1, term] - TERMS[row + 1, column, term])
    return upper + v * (lower - upper)
