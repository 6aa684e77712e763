"""Float64 oracle of SVGF (`svgf_cl.filters.svgf`), in NumPy."""

from __future__ import annotations

from collections.abc import Generator
from typing import ClassVar

import numpy as np

from svgf_cl.filters.kalman import Kalman
from svgf_cl.filters.svgf import Settings
from svgf_cl.oracle.spatial import luminance_tolerance, surface_weight, variance
from svgf_cl.oracle.taps import Array, depth_gradient, luminance, shifted, smoothed, square
from svgf_cl.oracle.temporal import Guides, Made, Stages, TemporalOracle, accumulated
from svgf_cl.oracle.wavelet import SPLINES


def atrous(
    illumination: Array,
    var: Array,
    guides: Guides,
    level: int,
    settings: Settings | Kalman,
    guidance: Array | None = None,
) -> tuple[Array, Array]:
    """Section 4: one level of the edge-avoiding a-trous wavelet filter.

    Parameters
    ----------
    illumination : (S, H, W, 3)
    var : (S, H, W), variance of the illumination's luminance.
    guides : Guides
    level : int, i, from 1; the taps lie 2^(i-1) pixels apart.
    settings : Settings or Kalman
    guidance : (S, H, W), optional
        Section 7: light is compared by the mean of its luminance and this.

    Returns
    -------
    illumination, var : filtered, of the same shapes.
    """
    step = 2 ** (level - 1)
    gradient = depth_gradient(guides.depth)
    luma = luminance(illumination)
    if guidance is not None:
        luma = (luma + guidance) / 2
    tolerance = luminance_tolerance(settings.sigma_luminance, smoothed(var, guides.hit), luma)
    color, squares, total = np.zeros_like(illumination), np.zeros_like(var), np.zeros_like(var)
    spline = SPLINES[settings.radius]
    for dx, dy in square(settings.radius):
        y, x, _ = shifted((dx, dy), guides.depth.shape, step)
        w_l = np.exp(-np.abs(luma - luma[:, y, x]) / tolerance)
        w = spline[dx] * spline[dy] * surface_weight(guides, gradient, (dx, dy), step, settings) * w_l
        color += w[..., None] * illumination[:, y, x]
        squares += w**2 * var[:, y, x]
        total += w
    total = np.where(guides.hit, total, 1)
    return (
        np.where(guides.hit[..., None], color / total[..., None], illumination),
        np.where(guides.hit, squares / total**2, var),
    )


class Oracle(TemporalOracle[Settings]):
    """SVGF over a sequence."""

    history: ClassVar[str] = "level_1"

    @property
    def alpha_moments(self) -> float:
        """The setting of that name."""
        return self.settings.alpha_moments

    def spatial(self, now: Stages, guides: Guides) -> Generator[Made, None, str]:
        """Yield the variance, then the levels."""
        yield "variance", {"variance": variance(accumulated(now, now["accumulated"]), guides, self.settings)}
        source = "accumulated", "variance"
        for level in range(1, self.settings.iterations + 1):
            target = f"level_{level}", f"level_{level}_variance"
            filtered = atrous(now[source[0]], now[source[1]], guides, level, self.settings)
            yield "atrous", dict(zip(target, filtered, strict=True))
            source = target
        return source[0]
