"""Float64 oracle of the bilateral filters SBF and LBF: distances between the surfaces of two pixels (section 8)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from svgf_cl.filters.bilateral import BilateralFilter
from svgf_cl.oracle.spatial import same_albedo
from svgf_cl.oracle.taps import Array, Mask, Offset, depth_gradient, shifted
from svgf_cl.oracle.temporal import Guides

NORMAL_FLOOR, NORMAL_MOST = 0.05, 0.5  # deviation of a normal: the least, and the limit of what is added to it


@dataclass(frozen=True)
class Deviations:
    """psi: the change of depth and normal from a pixel to the next one on its surface, (H, W) each."""

    depth: Array
    normal: Array

    @classmethod
    def of(cls, guides: Guides, slope_floor: float) -> Deviations:
        """The deviations of a frame."""
        slopes = np.abs(depth_gradient(guides.depth)).sum(axis=-1) + slope_floor * guides.depth
        change = sum(
            np.minimum(*(normal_change(guides, offset) for offset in pair))
            for pair in (((-1, 0), (1, 0)), ((0, -1), (0, 1)))
        )
        squares = np.minimum(change, NORMAL_MOST**2) + NORMAL_FLOOR**2
        return cls(np.where(guides.hit, slopes, 1), np.sqrt(squares))


def normal_change(guides: Guides, offset: Offset) -> Array:
    """|n - n'|^2 to the tap `offset` away, (H, W); 4, the largest possible value, if the tap is a miss."""
    y, x, inside = shifted(offset, guides.depth.shape)
    apart = np.square(guides.normal - guides.normal[y, x]).sum(axis=-1)
    return np.where(inside & guides.hit[y, x], apart, 4)


def surface_distance(guides: Guides, deviations: Deviations, offset: Offset) -> tuple[Array, Array]:
    """D_z and D_n for the tap `offset` away, (H, W) each; undefined at misses."""
    y, x, _ = shifted(offset, guides.depth.shape)
    depth = np.square((guides.depth - guides.depth[y, x]) / deviations.depth)
    return depth, np.square(guides.normal - guides.normal[y, x]).sum(axis=-1) / deviations.normal**2


def counts(guides: Guides, offset: Offset, settings: BilateralFilter) -> Mask:
    """Whether the tap `offset` away is a hit whose albedo is like the pixel's own: (H, W)."""
    y, x, inside = shifted(offset, guides.depth.shape)
    seen: Mask = inside & guides.hit & guides.hit[y, x] & same_albedo(guides, offset, settings.albedo_threshold)
    return seen
