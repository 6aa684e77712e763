"""Float64 oracle of what a-trous wavelet filters share: which neighbours lie on the same surface."""

from __future__ import annotations

import numpy as np

from svgf_cl.filters.wavelet import WaveletFilter
from svgf_cl.oracle.albedo import alike
from svgf_cl.oracle.taps import Array, Offset, dot, shifted
from svgf_cl.oracle.temporal import Guides

# By radius: of B3, and linear.
SPLINES = {2: {-2: 1 / 16, -1: 1 / 4, 0: 3 / 8, 1: 1 / 4, 2: 1 / 16}, 1: {-1: 1 / 4, 0: 1 / 2, 1: 1 / 4}}


def surface_weight(guides: Guides, gradient: Array, offset: Offset, step: int, settings: WaveletFilter) -> Array:
    """Section 4: w_z w_n w_a for the tap q = p + step * offset, (H, W); 1 at the centre, 0 where p or q is a miss."""
    dx, dy = offset
    y, x, inside = shifted(offset, guides.depth.shape, step)
    hits = inside & guides.hit & guides.hit[y, x]
    if dx == dy == 0:
        return hits.astype(np.float64)
    slope = settings.sigma_depth * np.abs(gradient @ np.array(offset))
    slope += settings.depth_slope_floor * guides.depth * max(abs(dx), abs(dy))
    w_z = np.exp(-np.abs(guides.depth - guides.depth[y, x]) / (step * np.where(hits, slope, 1)))
    w_n = np.exp(settings.sigma_normal * (dot(guides.normal, guides.normal[y, x]) - 1))
    if guides.albedo is not None:
        hits &= alike(guides.albedo, guides.albedo[y, x], settings.albedo_threshold)
    return np.where(hits, w_z * w_n, 0)
