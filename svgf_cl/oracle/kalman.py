"""Float64 oracle of Kalman (`svgf_cl.filters.kalman`), in NumPy: section 7 of docs/algorithm.md.

Arrays of every second pixel of every second row have the shape (ceil(H / 2), ceil(W / 2)), which is "(h, w)" below.
"""

from __future__ import annotations

from collections.abc import Generator, Iterable, Sequence

import numpy as np

from svgf_cl.filters.kalman import Kalman
from svgf_cl.frame import LUMINANCE
from svgf_cl.oracle.spatial import Facets, Tolerance, facet_weight, same_albedo
from svgf_cl.oracle.svgf import atrous
from svgf_cl.oracle.taps import GAUSSIAN, Array, Offset, depth_gradient, luminance, shifted, square
from svgf_cl.oracle.temporal import LENGTH_MAX, FilterOracle, Guides, Made, Past, Stages, footprint

RESIDUAL_GAIN = 0.3
LEAST_SPREAD = 1e-3  # the least deviation of a residual, relative to S
CORRELATED = {2: 1.0, 3: 1.49, 4: 2.54}  # by the number of the pass
STEPS = {2: 1, 3: 2, 4: 4}  # by the number of the pass, in coarse pixels
DOUBT_OF_CHANGE, RELATIVE_DOUBT, MOST_DOUBT = 4.0, 1e-5, 1e3
ENOUGH_AROUND = 1e-3  # the least sum of the weights of the coarse pixels
SHORT_HISTORY, SHARE_OF_VARIANCE = 0.5, 0.5
UNKNOWN = -1.0
NOTHING_KNOWN = 1e9  # the residual where nothing is known
CALIBRATION = 3.0  # factor of the standard error
LEAST_DIVISOR = 1e-30

EVERY_SECOND = np.s_[..., ::2, ::2]
BLOCK = [(dx, dy) for dy in (0, 1) for dx in (0, 1)]
SPLINE = [((dx, dy), 0.5 ** (abs(dx) + abs(dy))) for dx, dy in square(1)]  # (1/2, 1, 1/2) along both axes

Tap = tuple[Offset, float]  # an offset and its coefficient


def predict(now: Stages, guides: Guides, past: Past | None, settings: Kalman) -> dict[str, Array]:
    """Move the state of the previous frame along motion, and compare the new light with it."""
    light = now["demodulated"]
    predicted = {name: np.zeros(light.shape[:-1]) for name in ("spread", "inverse_count", "tone", "luminance")}
    color, before, known = np.zeros_like(light), np.zeros(light.shape[:-1]), np.zeros(guides.depth.shape, bool)
    if past is not None:
        around = footprint(guides, past.guides, settings)
        shown = luminance(past.stages["filtered"])
        state = {**past.stages, "spread": past.stages["sample_variance"], "luminance": shown}
        predicted = {name: around.mean(around.taps(state[name])) for name in predicted}
        color, before = (around.mean(around.taps(state[name])) for name in ("accumulated", "residual"))
        known = around.found
    surprise = np.sqrt(luminance(light)) - predicted["tone"]
    return {
        "predicted": color,
        **{f"predicted_{name}": values for name, values in predicted.items()},
        "innovation": light - color,
        "innovation_residual": np.where(known, before + RESIDUAL_GAIN * (surprise - before), NOTHING_KNOWN),
    }


def known_depth(now: Stages, guides: Guides) -> Array:
    """Depth where something is known of the light, otherwise 0."""
    return np.where(now["innovation_residual"][0] < NOTHING_KNOWN, guides.depth, 0)


def change_tolerance(settings: Kalman) -> Tolerance:
    """The tolerances by which the test compares surfaces."""
    return Tolerance(settings.change_sigma_depth, settings.change_sigma_normal, settings.depth_slope_floor)


def mean_over(taps: Iterable[Tap], values: Array, u: Array, facets: Facets, settings: Kalman) -> tuple[Array, Array]:
    """Means over taps of one surface: of `values` (S, H, W, n), and of the share u (H, W) of a sample's variance."""
    sums, squares, total = np.zeros_like(values), np.zeros_like(u), np.zeros_like(u)
    for offset, coefficient in taps:
        y, x, _ = shifted(offset, u.shape)
        w = coefficient * facet_weight(facets, offset, change_tolerance(settings))
        sums += w[..., None] * values[:, y, x]
        squares += w**2 * u[y, x]
        total += w
    total = np.where(total > 0, total, 1)
    return sums / total[..., None], squares / total**2


def innovations(now: Stages) -> Array:
    """D, l(D)^2, E and E^2 of every pixel: (S, H, W, 6)."""
    color, residual = now["innovation"], now["innovation_residual"][..., None]
    return np.concatenate((color, luminance(color)[..., None] ** 2, residual, residual**2), axis=-1)


def named(stage: str, means: Array, u: Array) -> dict[str, Array]:
    """The stages of one pass of the test, from its means (S, h, w, 6): d, r, e and f."""
    square_, residual, residual_square = np.moveaxis(means[..., 3:], -1, 0)
    return {
        f"{stage}_share": u,
        stage: means[..., :3],
        f"{stage}_square": square_,
        f"{stage}_residual": residual,
        f"{stage}_residual_square": residual_square,
    }


def stacked(now: Stages, stage: str) -> Array:
    """The means that `named` split into stages."""
    others = np.stack([now[f"{stage}_{name}"] for name in ("square", "residual", "residual_square")], axis=-1)
    return np.concatenate((now[stage], others), axis=-1)


def innovation_mean(now: Stages, guides: Guides, settings: Kalman) -> dict[str, Array]:
    """Pass 1 of the test: means at every second pixel of every second row."""
    facets = Facets(known_depth(now, guides), guides.normal, depth_gradient(guides.depth))
    taps = [(offset, 1.0) for offset in BLOCK]
    means, u = mean_over(taps, innovations(now), np.ones(guides.depth.shape), facets, settings)
    return {
        "facet_depth": facets.depth[EVERY_SECOND],
        "facet_gradient": facets.gradient[::2, ::2],
        "facet_normal": facets.normal[::2, ::2],
        **named("change_1", means[:, ::2, ::2], u[EVERY_SECOND]),
    }


def coarser_mean(now: Stages, number: int, settings: Kalman) -> tuple[Array, Array]:
    """Pass `number` = 2, 3, 4 of the test: means (S, h, w, 6), and u."""
    facets = Facets(now["facet_depth"], now["facet_normal"], now["facet_gradient"], spacing=2)
    step, finer = STEPS[number], f"change_{number - 1}"
    taps = [((step * dx, step * dy), h) for (dx, dy), h in SPLINE]
    return mean_over(taps, stacked(now, finer), now[f"{finer}_share"], facets, settings)


def believed(off: Array, variance: Array, share: Array, threshold: float) -> Array:
    """b: the share of a mean difference that counts as a change."""
    rest = (1 - share) * off
    significance = np.maximum(rest**2 / np.maximum(variance * share, LEAST_DIVISOR), LEAST_DIVISOR)
    return np.maximum(1 - threshold**2 / significance, 0)


def spread_over_space(means: Array) -> Array:
    """R, computed from means (..., 6)."""
    return np.maximum(means[..., 3] - luminance(means[..., :3]) ** 2, 0)


def detect(now: Stages, settings: Kalman) -> dict[str, Array]:
    """Pass 4, and the test from coarse to fine scales."""
    found = {4: coarser_mean(now, 4, settings)}
    found |= {number: (stacked(now, f"change_{number}"), now[f"change_{number}_share"]) for number in (3, 2)}
    least = (LEAST_SPREAD * now["predicted_tone"][EVERY_SECOND]) ** 2
    color, residual, doubt = (np.zeros_like(now[f"change_1{part}"]) for part in ("", "_residual", "_residual"))
    for number, (means, u) in found.items():
        d, e, f = means[..., :3], means[..., 4], means[..., 5]
        share = np.minimum(CORRELATED[number] * u, 1)
        b = believed(e - residual, np.maximum(f - e**2, least), share, settings.change_threshold)
        color = color + b[..., None] * (d - color)
        residual = residual + b * (e - residual)
        doubt = np.maximum(doubt * (1 - b) ** 2, b**2 * share)
    return {
        "correction": color,
        "correction_residual": residual,
        "correction_doubt": doubt,
        "correction_spread": spread_over_space(found[2][0]),
    }


def correction(now: Stages, guides: Guides, settings: Kalman) -> Array:
    """A, B, q and R of every pixel, (S, H, W, 6).

    They are computed from the coarse pixels around it, or by `direct` if none of these is on its surface.
    """
    shape = guides.depth.shape
    parts = [now[f"correction_{name}"][..., None] for name in ("residual", "doubt", "spread")]
    coarse = np.concatenate((now["correction"], *parts), axis=-1)
    facets = Facets(known_depth(now, guides), guides.normal, depth_gradient(guides.depth))
    total, sums = np.zeros(shape), np.zeros((len(coarse), *shape, 6))
    # at odd coordinates both coarse neighbours have half the weight; at even ones, one has all of it
    for offset, h in SPLINE:
        y, x, _ = shifted(offset, shape)
        w = np.where((x % 2 == 0) & (y % 2 == 0), h * facet_weight(facets, offset, change_tolerance(settings)), 0)
        total += w
        sums += w[..., None] * coarse[:, y // 2, x // 2]
    around = sums / np.maximum(total, ENOUGH_AROUND)[..., None]
    return np.where((total > ENOUGH_AROUND)[..., None], around, direct(now, facets, settings))


def direct(now: Stages, facets: Facets, settings: Kalman) -> Array:
    """A, B, q and R of every pixel, (S, H, W, 6), from a test over the 7x7 pixels around it."""
    taps = [(offset, 1.0) for offset in square(3)]
    means, share = mean_over(taps, innovations(now), np.ones(facets.depth.shape), facets, settings)
    e, f = means[..., 4], means[..., 5]
    least = (LEAST_SPREAD * now["predicted_tone"]) ** 2
    b = believed(e, np.maximum(f - e**2, least), share, settings.change_threshold)
    parts = [b * e, b**2 * share, spread_over_space(means)]
    return np.concatenate((b[..., None] * means[..., :3], np.stack(parts, axis=-1)), axis=-1)


def not_negative(color: Array) -> Array:
    """Clamp red, luminance and blue to at least 0, as the kernels do: (..., 3) of red, green and blue."""
    red, green, blue = LUMINANCE
    kept = np.maximum(np.stack((color[..., 0], luminance(color), color[..., 2]), axis=-1), 0)
    kept[..., 1] = (kept[..., 1] - red * kept[..., 0] - blue * kept[..., 2]) / green
    return kept


def update(now: Stages, guides: Guides, settings: Kalman) -> dict[str, Array]:
    """Correct the prediction by the change of light, then blend it with the new light by the Kalman gain."""
    known = known_depth(now, guides) > 0
    changed = np.where(known[..., None], correction(now, guides, settings), 0)
    color, (residual, doubt, spread) = changed[..., :3], np.moveaxis(changed[..., 3:], -1, 0)
    change = luminance(color)
    before = now["predicted_inverse_count"]
    spread = spread / (1 + np.minimum(before, 1))
    evenness = RELATIVE_DOUBT * luminance(now["predicted"]) ** 2
    doubt = doubt + DOUBT_OF_CHANGE * change**2 / (spread + evenness + LEAST_DIVISOR)
    count = np.minimum(np.maximum(before, 1 / LENGTH_MAX[settings.half_history]) + doubt, MOST_DOUBT)
    gain = np.maximum(count / (1 + count), settings.alpha_color)

    sample = not_negative(now["predicted"] + now["innovation"])  # c
    corrected = not_negative(now["predicted"] + color)
    phi, tone = np.sqrt(luminance(sample)), now["predicted_tone"] + residual
    off = luminance(sample) - luminance(corrected)
    sample_variance = np.where(known, (1 - gain) * (now["predicted_spread"] + gain * off**2), 0)
    inverse_count = np.where(known, gain**2 + (1 - gain) ** 2 * count, guides.hit)
    return {
        "accumulated": np.where(known[..., None], corrected + gain[..., None] * (sample - corrected), sample),
        "expected_variance": inverse_count * (sample_variance + np.where(known, inverse_count * spread, 0)),
        "sample_variance": sample_variance,
        "inverse_count": inverse_count,
        "tone": np.where(known, tone + gain * (phi - tone), phi),
        "residual": np.where(known, (1 - gain) * (now["innovation_residual"] - residual), 0),
        "expected_luminance": np.where(known, np.maximum(now["predicted_luminance"] + change, 0), UNKNOWN),
    }


def moments(values: Array, weights: Sequence[tuple[Offset, Array]]) -> tuple[Array, Array]:
    """Mean and variance of values (S, H, W) over taps with these weights (H, W)."""
    taps = [(w, values[:, y, x]) for offset, w in weights for y, x, _ in [shifted(offset, values.shape[1:])]]
    total = sum(w for w, _ in taps)
    total = np.where(total > 0, total, 1)
    mean = sum(w * tap for w, tap in taps) / total
    return mean, sum(w * (tap - mean) ** 2 for w, tap in taps) / total


def guidance(now: Stages, guides: Guides, settings: Kalman) -> dict[str, Array]:
    """The luminance by which the levels compare light, and the variance where history is short."""
    own = luminance(now["accumulated"])
    facets = Facets(guides.depth, guides.normal, depth_gradient(guides.depth))
    weights = {offset: facet_weight(facets, offset, change_tolerance(settings)) for offset in square(3)}
    smooth, _ = moments(own, [((dx, dy), GAUSSIAN[dx] * GAUSSIAN[dy] * weights[dx, dy]) for dx, dy in square(1)])
    alike = [(offset, w * same_albedo(guides, offset, settings.albedo_threshold)) for offset, w in weights.items()]
    _, spatial = moments(own, alike)
    past = now["expected_luminance"]
    guess = np.where(past < 0, smooth, past)
    short = guides.hit & (now["inverse_count"] > SHORT_HISTORY)
    return {
        "variance": np.where(short, SHARE_OF_VARIANCE * spatial, now["expected_variance"]),
        "guidance_1": np.where(guides.hit, smooth + guess - own, 0),
        "guidance": np.where(guides.hit, guess, 0),
    }


def standard_error(variance: Array, guides: Guides) -> Array:
    """The standard error of the result's luminance: (H, W)."""
    error: Array = CALIBRATION * np.sqrt(variance.sum(axis=0)) * luminance(guides.divisor * np.ones(3))
    return error


class Oracle(FilterOracle[Kalman]):
    """Kalman over a sequence."""

    def length(self, now: Stages) -> Array:
        """1 / W of the first signal."""
        inverse = now["inverse_count"][0]
        return np.where(inverse > 0, 1 / np.where(inverse > 0, inverse, 1), 0)

    def filtered(self, now: Stages, guides: Guides, past: Past | None) -> Generator[Made, None, str]:
        """Yield prediction, test, update, guidance, and then the levels."""
        settings = self.settings
        yield "predict", predict(now, guides, past, settings)
        yield "innovation_mean", innovation_mean(now, guides, settings)
        for number in (2, 3):
            yield "coarser_mean", named(f"change_{number}", *coarser_mean(now, number, settings))
        yield "detect", detect(now, settings)
        yield "update", update(now, guides, settings)
        yield "guidance", guidance(now, guides, settings)
        source = "accumulated", "variance"
        for level in range(1, settings.iterations + 1):
            name = f"level_{level}" if level < settings.iterations else "filtered"
            target = name, f"{name}_variance"
            compared = now["guidance_1" if level == 1 else "guidance"]
            light, variance = now[source[0]], now[source[1]]
            yield "atrous", dict(zip(target, atrous(light, variance, guides, level, settings, compared), strict=True))
            source = target
        if settings.standard_error:
            yield "standard_error", {"standard_error": standard_error(now[source[1]], guides)}
        return source[0]
