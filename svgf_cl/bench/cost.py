"""What a pass must at least move and compute per pixel, counted from its equation and not from its kernel.

Bytes: every plane a pass needs is read once and every plane it makes is written once; neighbours come from a cache
(`traffic`). Loads: every neighbour is loaded from there (`loads`).
Operations: the equations of docs/algorithm.md in single precision. An addition, multiplication, comparison with its
choice, absolute value, rounding, division and root count as one each, so a multiply-add counts as two. What is common
to several taps counts once. In a steady state: what a pass does only where history is short or lost is left out.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from svgf_cl.bench.loads import Loads, loads
from svgf_cl.bench.traffic import bytes_moved
from svgf_cl.filters.pipeline import Inputs, Pass
from svgf_cl.settings import Settings

DOT = 5  # x x' + y y' + z z'; a luminance too
EXP = {"precise": 14, "fast": 2}  # polynomial of degree 4, 2 a degree, and 6 to reduce the range; or a conversion
BLEND = 3  # a + t (b - a)
DISTANCE = 3  # |a - b| scale
GRADIENT = 10  # per axis two differences, two magnitudes, a choice
SAFE = 2  # finite? else another value


@dataclass(frozen=True)
class Cost:
    """Bytes moved, bytes loaded and floating-point operations; of a pixel, or of an image."""

    bytes: float
    loads: Loads
    flops: float

    def __mul__(self, pixels: int) -> Cost:
        return Cost(self.bytes * pixels, self.loads * pixels, self.flops * pixels)


def cost(entry: Pass, inputs: Inputs, settings: Settings) -> Cost:
    """What a pass costs per pixel."""
    moved = sum(bytes_moved(entry, name, inputs, settings) for name in (*entry.reads, *entry.writes))
    return Cost(moved, loads(entry, inputs, settings), OPERATIONS[entry.kernel](inputs, settings))


def demodulate(inputs: Inputs, settings: Settings) -> float:
    """Section 1: a unit normal, then radiance made safe, divided by albedo and clamped, and its luminance."""
    normal = DOT + 2 + 3 + SAFE
    albedo = 3 * (SAFE + 1) if inputs.albedo else 0
    emission = 3 * (SAFE + 2) if inputs.emission and inputs.signals == 1 else 0
    return normal + albedo + emission + inputs.signals * (3 * (SAFE + 1 + 2) + DOT)


def temporal(inputs: Inputs, settings: Settings) -> float:
    """Section 2: four taps of the footprint, each held against the surface, then the blend of colour and moments."""
    footprint = 2 * (1 + 2 + 2) + GRADIENT + 4  # clamp, floor and fraction per axis; tolerance of depth
    consistent = DOT + 1 + (4 + 2 + 1) + 1 + (1 if inputs.id else 0)  # normal; depth along the surface; hit; id
    weight = 3 + 1
    tap = consistent + weight + 2 * (1 + 3 * inputs.signals) + inputs.signals * (2 + 3 + 2)  # N, c; M; V + (M - M_h)^2
    blend = inputs.signals * (3 * BLEND + BLEND + 1 + 4)  # c; M; 1 - a; V
    return footprint + 4 * tap + 4 + blend  # N, 1 / N, the two shares


def variance(inputs: Inputs, settings: Settings) -> float:
    """Section 3 where history is long: a choice by it, and by whether anything was hit."""
    return 2 + inputs.signals


def atrous(inputs: Inputs, settings: Settings) -> float:
    """Section 4: one level; taps at +d and -d have the tolerance of depth in common.

    The three terms and the spline add up to one exponent; its factors are those of the pixel, not of the tap.
    """
    surface = GRADIENT + 3 + 2 + 1  # normal, slope and floor times their sigmas
    tolerance = 4 + 2 + 1  # |g . d|; plus the floor; reciprocal
    exponent = DISTANCE + 1 + 2 * 3  # of w_z and h; of w_n
    light = DISTANCE + 1 + EXP[settings.precision]  # of w_l; w
    sums = 2 * 3 + 1 + 2 + 1  # w c; w^2 Var; w
    smooth = 9 * (2 + 1 + 1) + 1 + 1 + 4 + 1  # 3x3 Gaussian over hits; root; the scale of w_l
    normalise = 1 + 3 + 2
    taps = (2 * settings.radius + 1) ** 2 - 1
    shared = surface + taps // 2 * tolerance + taps * exponent
    return shared + inputs.signals * (taps * (light + sums) + smooth + normalise)


def modulate(inputs: Inputs, settings: Settings) -> float:
    """Section 5: green from luminance, times albedo, plus emission."""
    green = 2 * 2 + 1 + 1
    albedo = SAFE + 2 if inputs.albedo else 0
    emission = SAFE + 2 if inputs.emission else 0
    return green + 3 * (inputs.signals - 1 + albedo + emission + 1)


def taa(inputs: Inputs, settings: Settings) -> float:
    """Section 6: nearest neighbour, tone map, 4x4 taps of history, clamp, blend and back."""
    tone = 8 + 2 + 3
    foremost = 9 * 2
    history = 2 * 16 + 16 * (1 + 2 * 3)
    extent = 8 * 2 * 3
    return foremost + tone + history + extent + 3 * (2 + BLEND) + 4 + 3 + 5


OPERATIONS: dict[str, Callable[[Inputs, Settings], float]] = {
    "demodulate": demodulate,
    "temporal": temporal,
    "variance": variance,
    "atrous": atrous,
    "modulate": modulate,
    "taa": taa,
}
