"""Float64 oracle of SVGF: `svgf_cl.filters.svgf` restated in NumPy."""

from __future__ import annotations

from collections.abc import Generator
from typing import ClassVar

import numpy as np

from svgf_cl.filters.kalman import Kalman
from svgf_cl.filters.svgf import Settings
from svgf_cl.oracle.taps import Array, depth_gradient, luminance, shifted, smoothed, square
from svgf_cl.oracle.temporal import Accumulated, Guides, Made, Stages, TemporalOracle, accumulated
from svgf_cl.oracle.wavelet import SPLINES, surface_weight

LONG_HISTORY, NEARLY_LONG = 4, 3.5  # frames
LUMINANCE_TOLERANCE = (1e-3, 1e-12)  # relative, and where all is black


def variance(past: Accumulated, guides: Guides, settings: Settings) -> Array:
    """Section 3: variance of luminance, (S, H, W), from the moments or, where history is short, from 7x7 neighbours."""
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
        Section 7: what light is compared by is half its luminance and half this.

    Returns
    -------
    illumination, var : as given, filtered.
    """
    step = 2 ** (level - 1)
    gradient = depth_gradient(guides.depth)
    luma = luminance(illumination)
    if guidance is not None:
        luma = (luma + guidance) / 2
    relative, least = LUMINANCE_TOLERANCE
    tolerance = settings.sigma_luminance * np.sqrt(smoothed(var, guides.hit)) + relative * luma + least
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
        """The setting."""
        return self.settings.alpha_moments

    def spatial(self, now: Stages, guides: Guides) -> Generator[Made, None, str]:
        """Variance, then the levels."""
        yield "variance", {"variance": variance(accumulated(now, now["accumulated"]), guides, self.settings)}
        source = "accumulated", "variance"
        for level in range(1, self.settings.iterations + 1):
            target = f"level_{level}", f"level_{level}_variance"
            filtered = atrous(now[source[0]], now[source[1]], guides, level, self.settings)
            yield "atrous", dict(zip(target, filtered, strict=True))
            source = target
        return source[0]
