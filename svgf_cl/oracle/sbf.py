"""Float64 oracle of SBF (`svgf_cl.filters.sbf`), in NumPy."""

from __future__ import annotations

from collections.abc import Generator, Sequence
from typing import ClassVar

import numpy as np

from svgf_cl.filters.sbf import Sbf
from svgf_cl.oracle.bilateral import Deviations, counts, surface_distance
from svgf_cl.oracle.spatial import surface_weight, variance
from svgf_cl.oracle.taps import Array, depth_gradient, luminance, shifted, square, window
from svgf_cl.oracle.temporal import Guides, Made, Stages, TemporalOracle, accumulated

SIGMAS = (1, 2, 4, 8)  # pixels
MOST_OF_A_FRAME = 0.9  # without accumulation, nothing is known of the variance over time
SMOOTHED = 3  # pixels to either side, for smoothing the risk


def scales(light: Array, guides: Guides, settings: Sbf) -> list[tuple[Array, Array]]:
    """Section 8: light (S, H, W, 3) filtered at each scale, and the sum of the weights, (H, W).

    The centre's weight is 1.
    """
    deviations = Deviations.of(guides, settings.depth_slope_floor)
    sums = [(light.copy(), np.ones(guides.depth.shape)) for _ in SIGMAS]
    for offset in window(2 * max(SIGMAS), guides.depth.shape):
        y, x, _ = shifted(offset, guides.depth.shape)
        d_z, d_n = surface_distance(guides, deviations, offset)
        exponent = d_z / settings.gamma_depth**2 + d_n / settings.gamma_normal**2
        seen, tap = counts(guides, offset, settings), light[:, y, x]
        for sigma, (color, total) in zip(SIGMAS, sums, strict=True):
            if np.abs(offset).max() <= 2 * sigma:
                w = np.where(seen, np.exp(-(exponent + np.dot(offset, offset) / sigma**2) / 2), 0)
                color += w[..., None] * tap
                total += w
    return [(color / total[..., None], total) for color, total in sums]


def risk(filtered: Array, total: Array, light: Array, noise: Array) -> Array:
    """Stein's unbiased risk estimate of luminance, without the term -v, (S, H, W): Li et al. 2012, equation 3."""
    return np.square(luminance(filtered) - luminance(light)) + 2 * noise / total


def smoothed_over_surface(values: Array, guides: Guides, settings: Sbf) -> Array:
    """Sum of values (..., H, W) over a window, with weights between surfaces."""
    gradient = depth_gradient(guides.depth)
    total = np.zeros_like(values)
    for offset in square(SMOOTHED):
        y, x, _ = shifted(offset, guides.depth.shape)
        w = surface_weight(guides, gradient, offset, 1, settings) if any(offset) else 1
        total += w * values[..., y, x]
    return total


def chosen(lights: Sequence[Array], risks: Sequence[Array], guides: Guides, settings: Sbf) -> Array:
    """The light (S, H, W, 3) of the scale with the least smoothed risk; of two equal scales, the smaller one."""
    best = np.argmin(smoothed_over_surface(np.stack(risks), guides, settings), axis=0)
    light: Array = np.take_along_axis(np.stack(lights), best[None, ..., None], axis=0)[0]
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
        for number, (filtered, total) in enumerate(scales(now["accumulated"], guides, self.settings), 1):
            made |= {f"scale_{number}": filtered, f"risk_{number}": risk(filtered, total, now["accumulated"], noise)}
        yield "bilateral", made
        numbers = range(1, len(SIGMAS) + 1)
        lights, risks = ([now[f"{name}_{number}"] for number in numbers] for name in ("scale", "risk"))
        yield "select_scale", {"filtered": chosen(lights, risks, guides, self.settings)}
        return "filtered"
