"""Float64 oracle of SBF (`svgf_cl.filters.sbf`), in NumPy."""

from __future__ import annotations

from collections.abc import Generator, Sequence
from typing import ClassVar

import numpy as np

from svgf_cl.filters.sbf import Sbf
from svgf_cl.oracle.bilateral import Deviations, counts, surface_distance
from svgf_cl.oracle.spatial import surface_weight, variance
from svgf_cl.oracle.taps import Array, depth_gradient, luminance, shifted, square
from svgf_cl.oracle.temporal import Guides, Made, Stages, TemporalOracle, accumulated

SIGMAS = (1, 2, 4, 8)  # pixels
MOST_OF_A_FRAME = 0.9  # without accumulation, nothing is known of the variance over time
SMOOTHED = 3  # pixels to either side, for smoothing the risk


def scale(light: Array, guides: Guides, sigma: float, settings: Sbf) -> tuple[Array, Array]:
    """Section 8: light (S, H, W, 3) filtered at one scale, and the sum of the weights, (H, W).

    The centre's weight is 1.
    """
    deviations = Deviations.of(guides, settings.depth_slope_floor)
    color, total = light.copy(), np.ones(guides.depth.shape)
    for offset in square(int(2 * sigma)):
        if not any(offset):
            continue
        y, x, _ = shifted(offset, guides.depth.shape)
        d_z, d_n = surface_distance(guides, deviations, offset)
        exponent = d_z / settings.gamma_depth**2 + d_n / settings.gamma_normal**2 + np.dot(offset, offset) / sigma**2
        w = np.where(counts(guides, offset, settings), np.exp(-exponent / 2), 0)
        color += w[..., None] * light[:, y, x]
        total += w
    return color / total[..., None], total


def risk(filtered: Array, total: Array, light: Array, noise: Array) -> Array:
    """Stein's unbiased risk estimate of luminance, without the term -v, (S, H, W): Li et al. 2012, equation 3."""
    return np.square(luminance(filtered) - luminance(light)) + 2 * noise / total


def smoothed_over_surface(values: Array, guides: Guides, settings: Sbf) -> Array:
    """Sum of values (S, H, W) over a window, with weights between surfaces."""
    gradient = depth_gradient(guides.depth)
    total = np.zeros_like(values)
    for offset in square(SMOOTHED):
        y, x, _ = shifted(offset, guides.depth.shape)
        w = surface_weight(guides, gradient, offset, 1, settings) if any(offset) else 1
        total += w * values[:, y, x]
    return total


def chosen(scales: Sequence[Array], risks: Sequence[Array], guides: Guides, settings: Sbf) -> Array:
    """The light (S, H, W, 3) of the scale with the least smoothed risk; of two equal scales, the smaller one."""
    best = np.argmin([smoothed_over_surface(each, guides, settings) for each in risks], axis=0)
    light: Array = np.take_along_axis(np.stack(scales), best[None, ..., None], axis=0)[0]
    return light


class Oracle(TemporalOracle[Sbf]):
    """SBF over a sequence."""

    history: ClassVar[str] = "accumulated"

    def spatial(self, now: Stages, guides: Guides) -> Generator[Made, None, str]:
        """Yield the variance, the scales, and the choice."""
        yield "variance", {"variance": variance(accumulated(now, now["accumulated"]), guides, self.settings)}
        alpha = self.settings.alpha_color
        share = np.minimum(np.maximum(1 / np.maximum(now["history_length"], 2), alpha / (2 - alpha)), MOST_OF_A_FRAME)
        noise = now["variance"] * share / (1 - share)
        made: dict[str, Array] = {}
        for number, sigma in enumerate(SIGMAS, 1):
            filtered, total = scale(now["accumulated"], guides, sigma, self.settings)
            made |= {f"scale_{number}": filtered, f"risk_{number}": risk(filtered, total, now["accumulated"], noise)}
        yield "bilateral", made
        numbers = range(1, len(SIGMAS) + 1)
        scales, risks = ([now[f"{name}_{number}"] for number in numbers] for name in ("scale", "risk"))
        yield "select_scale", {"filtered": chosen(scales, risks, guides, self.settings)}
        return "filtered"
