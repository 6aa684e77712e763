"""Float64 oracle of the spatial filters: weights between surfaces, and the variance of light."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from svgf_cl.filters.spatial import SpatialFilter
from svgf_cl.oracle.albedo import alike
from svgf_cl.oracle.taps import Array, Mask, Offset, depth_gradient, dot, shifted, square
from svgf_cl.oracle.temporal import Accumulated, Guides

LONG_HISTORY, NEARLY_LONG = 4, 3.5  # frames
LUMINANCE_TOLERANCE = (1e-3, 1e-12)  # relative, and absolute for black


@dataclass(frozen=True, eq=False)
class Facets:
    """The surfaces at the pixels of a grid.

    Parameters
    ----------
    depth : (H, W); 0 at pixels that do not count.
    normal : (H, W, 3)
    gradient : (H, W, 2), g.
    spacing : int, distance in pixels between neighbours of the grid.
    """

    depth: Array
    normal: Array
    gradient: Array
    spacing: int = 1


@dataclass(frozen=True)
class Tolerance:
    """How much neighbours on one surface may differ: sigma_depth, sigma_normal and depth_slope_floor."""

    depth: float
    normal: float
    slope_floor: float

    @classmethod
    def of(cls, settings: SpatialFilter) -> Tolerance:
        """The tolerance of a filter."""
        return cls(settings.sigma_depth, settings.sigma_normal, settings.depth_slope_floor)


def surface_weight(guides: Guides, gradient: Array, offset: Offset, step: int, settings: SpatialFilter) -> Array:
    """Section 4: w_z w_n w_a for the tap q = p + step * offset, (H, W); 1 at the centre, 0 where p or q is a miss."""
    facets = Facets(guides.depth, guides.normal, gradient)
    away = (step * offset[0], step * offset[1])
    return facet_weight(facets, away, Tolerance.of(settings)) * same_albedo(guides, away, settings.albedo_threshold)


def facet_weight(facets: Facets, offset: Offset, tolerance: Tolerance) -> Array:
    """Section 4: w_z w_n for the tap that is `offset` away on the grid, (H, W); 1 at the centre."""
    y, x, inside = shifted(offset, facets.depth.shape)
    hits = inside & (facets.depth > 0) & (facets.depth[y, x] > 0)
    if not any(offset):
        return hits.astype(np.float64)
    apart = facets.spacing * np.array(offset)
    slope = tolerance.depth * np.abs(facets.gradient @ apart)
    slope += tolerance.slope_floor * facets.depth * np.abs(apart).max()
    w_z = np.exp(-np.abs(facets.depth - facets.depth[y, x]) / np.where(hits, slope, 1))
    w_n = np.exp(tolerance.normal * (dot(facets.normal, facets.normal[y, x]) - 1))
    return np.where(hits, w_z * w_n, 0)


def same_albedo(guides: Guides, offset: Offset, octaves: float) -> Mask:
    """Section 4: w_a for the tap p + offset, (H, W); true at the centre."""
    y, x, inside = shifted(offset, guides.depth.shape)
    if guides.codes is None or not any(offset):
        return inside
    return alike(guides.codes, guides.codes[y, x], octaves)


def variance(past: Accumulated, guides: Guides, settings: SpatialFilter) -> Array:
    """Section 3: variance of luminance, (S, H, W), from the moments or, with short history, from 7x7 neighbours."""
    gradient = depth_gradient(guides.depth)
    length = past.length
    taps = []
    for offset in square(3):
        y, x, _ = shifted(offset, guides.depth.shape)
        w = surface_weight(guides, gradient, offset, 1, settings)
        taps.append((w, past.mean[:, y, x], past.variance[:, y, x]))
    total = np.where(guides.hit, sum(w for w, _, _ in taps), 1)
    mean = sum(w * m for w, m, _ in taps) / total
    pooled = sum(w * (v + (m - mean) ** 2) for w, m, v in taps) / total
    spatial = LONG_HISTORY / np.maximum(length, 1) * pooled
    return np.where(guides.hit, np.where(length >= NEARLY_LONG, past.variance, spatial), 0)


def luminance_tolerance(sigma: float, variance: Array, luma: Array) -> Array:
    """Section 4: the tolerated difference of luminance, from the smoothed variance and the luminance, (S, H, W)."""
    relative, least = LUMINANCE_TOLERANCE
    tolerance: Array = sigma * np.sqrt(variance) + relative * luma + least
    return tolerance
