"""Floating-point operations per pixel of the passes, counted from the equations and not from the kernels.

The equations are in docs/algorithm.md; precision is single. An addition, multiplication, absolute value, rounding,
division or root counts as one operation, and so does a comparison together with the choice that follows it. So a
multiply-add counts as two. Work that several taps share counts once. The count is for a steady state, without the work
that is done only where history is short or lost.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from svgf_cl.filters.signals import Inputs

DOT = 5  # x x' + y y' + z z'; also for a luminance
# polynomial of degree 4 with 2 per degree, and 6 to reduce the range; or one conversion
EXP = {"precise": 14, "fast": 2}
BLEND = 3  # a + t (b - a)
DISTANCE = 3  # |a - b| scale
ALBEDO = 5 + 2  # compare all channels of a code with two bounds; a choice
GRADIENT = 10  # per axis: two differences, two magnitudes, a choice
SAFE = 2  # replace a value that is not finite
SMOOTH_VARIANCE = 9 * (2 + 1 + 1) + 1 + 1 + 4 + 1  # 3x3 Gaussian over hits; root; the scale of w_l
WEIGHT = DISTANCE + 1 + 2 * 3 + EXP["precise"]  # the weight of a tap by depth and normal
TOLERANCE = 4 + 2 + 1  # tolerance of depth at a tap: |g . d|; plus the floor; reciprocal
FOOTPRINT = 2 * (1 + 2 + 2) + GRADIENT + 4  # clamp, floor and fraction per axis; tolerance of depth
FACET = 3 + 2 + 1  # normal, slope and floor times their sigmas
FEATURES = GRADIENT + 6 + 3 + 4 * (DOT + 3) + 2 + 2 + 2  # 1 / psi_z; 2 n; |n - n'|^2 of four; the smaller; 1 / psi_n^2


def demodulate(inputs: Inputs) -> float:
    """Section 1: a unit normal, then radiance made safe, divided by albedo and clamped, and its luminance."""
    signals = len(inputs.signals)
    normal = DOT + 2 + 3 + SAFE
    albedo = 3 * (SAFE + 1 + 1) + 4 if inputs.divides_by_albedo else 0  # the code of albedo; the floors
    emission = 3 * (SAFE + 2) if inputs.emission_signal >= 0 else 0
    return normal + albedo + emission + signals * (3 * (SAFE + 1 + 2) + DOT)


def temporal(inputs: Inputs) -> float:
    """Section 2: compare the four taps of the footprint with the surface, then blend colour and moments."""
    signals = len(inputs.signals)
    tap = tap_of_the_past(inputs) + 2 * (1 + 3 * signals) + signals * (2 + 3 + 2)  # N, c; M; V + (M - M_h)^2
    blend = signals * (3 * BLEND + BLEND + 1 + 4)  # c; M; 1 - a; V
    return FOOTPRINT + 4 * tap + 4 + blend  # N, 1 / N, the two shares


def tap_of_the_past(inputs: Inputs) -> float:
    """Section 2: whether a tap shows the surface, and its weight."""
    consistent = DOT + 1 + (4 + 2 + 1) + 1 + (1 if inputs.id else 0)  # normal; depth along the surface; hit; id
    return consistent + 3 + 1 + (ALBEDO + 1 if inputs.divides_by_albedo else 0)


def predict(inputs: Inputs) -> float:
    """Section 7: four taps of the footprint, and the innovation."""
    planes = 3 + 5  # H; V, W, S, E, G
    tap = tap_of_the_past(inputs) + 1 + 2 * planes * len(inputs.signals)
    innovation = 3 + 1 + 1 + BLEND  # D; phi; phi - S; E
    return FOOTPRINT + 4 * tap + 1 + len(inputs.signals) * (planes + innovation)


def mean_of_change(taps: int, signals: int) -> float:
    """Section 7: one pass of the test, over `taps` taps and the centre; opposite taps share the tolerance of depth."""
    sums = 2 * 3 + 2 + 2 + 2  # d, r, e, f
    return FACET + (taps + 1) // 2 * TOLERANCE + taps * (WEIGHT + 4) + (taps + 1) * signals * sums + 1 + signals * 6


def detect(signals: int) -> float:
    """Section 7: three scales of the test; R."""
    scale = 1 + 3 + 3 + 3 + 3 * BLEND + 2 + 6  # e - B; its noise; t^2; b; A; B; q
    return signals * (3 * scale + 2 + 2)


def update(inputs: Inputs) -> float:
    """Section 7: the correction from the neighbours, the gain, the blend; on average 9/4 taps are read."""
    signals = len(inputs.signals)
    tap = TOLERANCE + WEIGHT + 2 + 2 * 6 * signals
    gain = 2 + 7 + 3 + 3 + 3  # R; q; W; a; Var
    blend = 3 * (2 + BLEND) + 2 + BLEND + 2 + 4 + 3 + 2  # H; S; E; V; W; G
    return GRADIENT + FACET + 9 / 4 * tap + 1 + signals * (6 + gain + blend)


def guidance(inputs: Inputs) -> float:
    """Section 7: nine taps of luminance; opposite taps share the tolerance of depth."""
    signals = len(inputs.signals)
    return GRADIENT + FACET + 4 * TOLERANCE + 8 * (WEIGHT + 1) + 9 * (1 + 2 * signals) + signals * (1 + 3)


@dataclass(frozen=True)
class LightOperations:
    """The operations that a wavelet filter does with the light of each signal.

    Parameters
    ----------
    weight : float
        For the weight of a tap's light, including its exponential.
    sums : float
        For adding a tap to the sums.
    once : float
        Once per pixel.
    """

    weight: float
    sums: float
    once: float


def wavelet(inputs: Inputs, taps: int, light: LightOperations) -> float:
    """Section 4: one level, over `taps` taps and the centre; the taps at +d and -d share the tolerance of depth.

    The terms and the spline add up to one exponent; its factors are computed once per pixel, not once per tap.
    """
    exponent = DISTANCE + 1 + 2 * 3  # w_z and h; w_n
    exponent += ALBEDO if inputs.divides_by_albedo else 0  # w_a
    per_signal = taps * (light.weight + light.sums) + light.once
    return GRADIENT + FACET + taps // 2 * TOLERANCE + taps * exponent + len(inputs.signals) * per_signal


def feature_distance(inputs: Inputs) -> float:
    """Section 8: D_z, D_n and w_a of a tap."""
    return 3 + DOT + 3 + 1 + (ALBEDO if inputs.divides_by_albedo else 0)


def scales(inputs: Inputs, taps: Sequence[int], exponential: float) -> float:
    """Section 8: the cross-bilateral filter of SBF, over `taps` taps and the centre at each scale, and its risk."""
    signals = len(inputs.signals)
    weights = max(taps) * (feature_distance(inputs) + 4 + exponential + 2)
    sums = sum(taps) * (2 + signals * (2 * 3 + 1))
    share = 2 + 2 + 2 + 2  # 1 / N; alpha / (2 - alpha) and the greater; the limit; s / (1 - s)
    return FEATURES + weights + sums + share + signals * (2 + len(taps) * (1 + 3 + 2 + 2))


def window(inputs: Inputs, taps: int, exponential: float) -> float:
    """Section 8: the cross-bilateral filter of LBF, over `taps` taps and the centre, with parameters for each pixel."""
    signals = len(inputs.signals)
    weight = 3 + 4 * 2 + exponential + 2  # D_l; the exponent; whether it counts
    once = SMOOTH_VARIANCE + 4 + 1 + 3  # scaling the parameters; the quotients
    return FEATURES + taps * (feature_distance(inputs) + signals * (weight + 2 * 3 + 1)) + signals * once


def network(inputs: Inputs, taps: int, layers: tuple[int, int, int], exponential: float) -> float:
    """Section 8: statistics of four features over `taps` taps, and the layers of LBF's network.

    Signals share the statistics of the surface.
    """
    sees, hidden, makes = layers
    signals = len(inputs.signals)
    channels = signals + 1 + 3 + (1 if inputs.divides_by_albedo else 0)  # light, depth, normal, albedo
    sums = taps * (1 + 1 + 2 + 2) + 9 * (1 + 2 + 2)  # f(q) - f(p); its sum; the sum of squares; the sum of magnitudes
    ends = 2 * (1 + 1 + 2 + 2) + 2 * 3 + 1  # both neighbourhoods: means; deviation; then the gradient
    squashing = sees * (1 + 1 + 1 + 1) + hidden * 3
    products = 2 * sees * hidden + 2 * hidden * makes
    per_signal = squashing + products + SMOOTH_VARIANCE + makes * (2 + exponential)
    return 2 * taps + channels * (sums + ends) + signals * per_signal


def choice(inputs: Inputs, taps: int, candidates: int) -> float:
    """Section 8: smooth SBF's risks over `taps` taps and the centre, and choose the least one."""
    signals = len(inputs.signals)
    exponent = DISTANCE + 1 + 2 * 3 + (ALBEDO if inputs.divides_by_albedo else 0)
    weights = GRADIENT + FACET + taps // 2 * TOLERANCE + taps * (exponent + EXP["precise"])
    return weights + signals * candidates * (2 * taps + 1 + 3)


def modulate(inputs: Inputs) -> float:
    """Section 5: green from luminance, times albedo, plus emission."""
    green = 2 * 2 + 1 + 1
    albedo = SAFE + 2 + 2 if inputs.divides_by_albedo else 0
    emission = SAFE + 2 if inputs.emission else 0
    return green + 3 * (len(inputs.signals) - 1 + albedo + emission + 1)


def standard_error(inputs: Inputs) -> float:
    """Section 7: the root of the variances' sum, times the luminance of albedo'."""
    return len(inputs.signals) + 1 + (3 * (SAFE + 1 + 1) + 4 + DOT + 1 if inputs.divides_by_albedo else 0)


def taa(*, filters_pixels: bool) -> float:
    """Section 6: nearest neighbour, longest history, YCoCg and back, 4x4 taps, clamp, blend, 3x3 pixel filter."""
    ycocg = 3 + 4
    foremost, longest = 9 * 2, 9 * 2
    history = 2 * 16 + 16 * (1 + 2 * 3)
    extent = 8 * 2 * 3
    pixel_filter = 9 * 2 * 3 if filters_pixels else 0
    return foremost + longest + ycocg + history + extent + pixel_filter + 3 * (2 + BLEND) + 4 + 3
