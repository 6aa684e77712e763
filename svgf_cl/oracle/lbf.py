"""Float64 oracle of LBF (`svgf_cl.filters.lbf`), in NumPy."""

from __future__ import annotations

from collections.abc import Generator
from typing import ClassVar

import numpy as np

from svgf_cl.filters.lbf import Lbf, Network
from svgf_cl.frame import Shape
from svgf_cl.oracle.albedo import OCTAVE
from svgf_cl.oracle.bilateral import Deviations, counts, surface_distance
from svgf_cl.oracle.spatial import luminance_tolerance, variance
from svgf_cl.oracle.taps import Array, Mask, Offset, luminance, shifted, smoothed, square, window
from svgf_cl.oracle.temporal import Guides, Made, Stages, TemporalOracle, accumulated

WINDOW = 10  # pixels to either side, for the filter
NEAR, WIDE = 1, 3  # pixels to either side, for the neighbourhoods of the statistics
# the value of a statistic that becomes 1/2
HALFWAY = {"light": 0.3, "depth": 0.01, "normal": 0.1, "albedo": 0.5, "noise": 1.0}
BLACK = 1e-12  # added to the mean of light before it is a divisor
EXPONENTS = (-24.0, 10.0)  # least and greatest exponent of a parameter, which is a power of two


def squashed(value: Array, halfway: float) -> Array:
    """Return value / (|value| + halfway), in -1..1."""
    result: Array = value / (np.abs(value) + halfway)
    return result


def features(light: Array, guides: Guides) -> dict[str, Array]:
    """The features by name, each (S or 1, H, W, channels); albedo is in octaves, as the mean of its channels."""
    octaves = np.zeros(guides.depth.shape) if guides.codes is None else guides.codes.mean(axis=-1) / OCTAVE
    return {
        "light": luminance(light)[..., None],
        "depth": guides.depth[None, ..., None],
        "normal": guides.normal[None],
        "albedo": octaves[None, ..., None],
    }


def difference(values: Array, guides: Guides, offset: Offset) -> tuple[Array, Mask]:
    """The difference between a tap and the pixel, 0 unless both are hits; and whether both are hits, (H, W)."""
    y, x, inside = shifted(offset, guides.depth.shape)
    seen: Mask = inside & guides.hit & guides.hit[y, x]
    return np.where(seen[..., None], values[:, y, x] - values, 0), seen


def spread(values: Array, guides: Guides, radius: int) -> tuple[Array, Array, Array]:
    """Deviation, mean absolute difference from the pixel, and mean difference, (S, H, W[, channels]); section 8."""
    total: Array = np.zeros(guides.depth.shape)
    first, second, absolute = np.zeros_like(values), np.zeros(values.shape[:-1]), np.zeros(values.shape[:-1])
    for offset in square(radius):
        off, seen = difference(values, guides, offset)
        total = total + seen
        first += off
        second += np.square(off).sum(axis=-1)
        absolute += np.abs(off).sum(axis=-1)
    total = np.maximum(total, 1)
    mean = first / total[..., None]
    squares = np.maximum(second / total - np.square(mean).sum(axis=-1), 0)
    return np.sqrt(squares), absolute / total, mean


def gradient_of(values: Array, guides: Guides) -> Array:
    """Length of the central difference per pixel, 0 along an axis if a neighbour is a miss: (S, H, W)."""
    squares = np.zeros(values.shape[:-1])
    for dx, dy in ((1, 0), (0, 1)):
        (ahead, seen), (behind, too) = (difference(values, guides, at) for at in ((dx, dy), (-dx, -dy)))
        along = np.where((seen & too)[..., None], (ahead - behind) / 2, 0)
        squares += np.square(along).sum(axis=-1)
    return np.sqrt(squares)


def statistics(light: Array, noise: Array, length: Array, guides: Guides) -> Array:
    """The input of the network, section 8: (S, H, W, INPUTS).

    Parameters
    ----------
    light : (S, H, W, 3)
    noise : (S, H, W), variance of luminance.
    length : (H, W), frames.
    guides : Guides
    """
    found: list[Array] = []
    _, _, off = spread(luminance(light)[..., None], guides, WIDE)
    mean = luminance(light) + off[..., 0] + BLACK
    one = np.ones(1)
    units = {"light": mean, "depth": np.where(guides.hit, guides.depth, 1)[None], "normal": one, "albedo": one}
    for name, values in features(light, guides).items():
        unit, halfway = units[name], HALFWAY[name]
        for radius in (NEAR, WIDE):
            deviation, absolute, offset = spread(values, guides, radius)
            signed = np.sqrt(np.square(offset).sum(axis=-1)) if name == "normal" else offset[..., 0]
            found += [squashed(each / unit, halfway) for each in (deviation, absolute, signed)]
        found.append(squashed(gradient_of(values, guides) / unit, halfway))
    for each in (noise, smoothed(noise, guides.hit)):
        found.append(squashed(np.sqrt(each) / mean, HALFWAY["noise"]))
    found.append((1 / np.maximum(length, 1))[None])
    return np.stack([np.broadcast_to(each, (len(light), *guides.depth.shape)) for each in found], axis=-1)


def parameters(seen: Array, network: Network) -> Array:
    """The filter's parameters (..., OUTPUTS), which the network computes from statistics (..., INPUTS)."""
    hidden = seen @ network.first.T + network.first_bias
    hidden = hidden / (1 + np.abs(hidden))
    made: Array = np.exp2(np.clip(hidden @ network.second.T + network.second_bias, *EXPONENTS))
    return made


def filtered(light: Array, noise: Array, chosen: Array, guides: Guides, settings: Lbf) -> Array:
    """Section 8: the bilateral filter of light (S, H, W, 3) with the parameters (S, H, W, OUTPUTS) of each pixel."""
    deviations = Deviations.of(guides, settings.depth_slope_floor)
    luma = luminance(light)
    tolerance = luminance_tolerance(1.0, smoothed(noise, guides.hit), luma)
    color, total = light.copy(), np.ones_like(luma)
    for offset in window(WINDOW, guides.depth.shape):
        y, x, _ = shifted(offset, guides.depth.shape)
        d_z, d_n = surface_distance(guides, deviations, offset)
        d_l = np.square((luma - luma[:, y, x]) / tolerance)
        distances = (np.full_like(d_z, np.dot(offset, offset)), d_z, d_n, d_l)
        exponent = np.zeros_like(luma)
        for k, distance in enumerate(distances):
            exponent += chosen[..., k] * distance
        w = np.where(counts(guides, offset, settings), np.exp2(-exponent), 0)
        color += w[..., None] * light[:, y, x]
        total += w
    result: Array = color / total[..., None]
    return result


class Oracle(TemporalOracle[Lbf]):
    """LBF over a sequence."""

    history: ClassVar[str] = "accumulated"

    def __init__(self, shape: Shape, settings: Lbf) -> None:
        super().__init__(shape, settings)
        self._network = Network.shipped()

    def spatial(self, now: Stages, guides: Guides) -> Generator[Made, None, str]:
        """Yield the variance, the network, and the window."""
        yield "variance", {"variance": variance(accumulated(now, now["accumulated"]), guides, self.settings)}
        seen = statistics(now["accumulated"], now["variance"], now["history_length"], guides)
        yield "network", {"parameters": np.where(guides.hit[..., None], parameters(seen, self._network), 0)}
        made = filtered(now["accumulated"], now["variance"], now["parameters"], guides, self.settings)
        yield "bilateral", {"filtered": made}
        return "filtered"
