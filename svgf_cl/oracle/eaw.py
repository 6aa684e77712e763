"""Float64 oracle of EAW (`svgf_cl.filters.eaw`), in NumPy."""

from __future__ import annotations

from collections.abc import Generator
from typing import ClassVar

import numpy as np

from svgf_cl.filters.eaw import Eaw
from svgf_cl.oracle.spatial import surface_weight
from svgf_cl.oracle.taps import Array, depth_gradient, shifted, square
from svgf_cl.oracle.temporal import Guides, Made, Stages, TemporalOracle
from svgf_cl.oracle.wavelet import SPLINES


def atrous(illumination: Array, guides: Guides, level: int, settings: Eaw) -> Array:
    """One level of the edge-avoiding a-trous wavelet filter (Dammertz et al. 2010, equation 6).

    Parameters
    ----------
    illumination : (S, H, W, 3)
    guides : Guides
    level : int, i, from 1; the taps lie 2^(i-1) pixels apart.
    settings : Eaw

    Returns
    -------
    illumination : filtered, of the same shape.
    """
    step = 2 ** (level - 1)
    gradient = depth_gradient(guides.depth)
    tolerance = settings.sigma_color / step
    color, total = np.zeros_like(illumination), np.zeros(illumination.shape[:-1])
    spline = SPLINES[settings.radius]
    for dx, dy in square(settings.radius):
        y, x, _ = shifted((dx, dy), guides.depth.shape, step)
        apart = ((illumination - illumination[:, y, x]) ** 2).sum(axis=-1)
        w_c = np.exp(-apart / tolerance**2)
        w = spline[dx] * spline[dy] * surface_weight(guides, gradient, (dx, dy), step, settings) * w_c
        color += w[..., None] * illumination[:, y, x]
        total += w
    total = np.where(guides.hit, total, 1)
    filtered: Array = np.where(guides.hit[..., None], color / total[..., None], illumination)
    return filtered


class Oracle(TemporalOracle[Eaw]):
    """EAW over a sequence."""

    history: ClassVar[str] = "accumulated"

    def spatial(self, now: Stages, guides: Guides) -> Generator[Made, None, str]:
        """Yield the levels."""
        source = "accumulated"
        for level in range(1, self.settings.iterations + 1):
            target = f"level_{level}"
            yield "atrous", {target: atrous(now[source], guides, level, self.settings)}
            source = target
        return source
