"""Checks that colour is proportional to albedo, contains emission, and is the sum of its parts.

Neighbouring pixels with the same normal get the same light, so their colours have the ratio of their albedos. Despite
noise this is true on average: if a and b are two colours, each divided by its albedo, the mean of (a - b) / (a + b) is
0. The same is tested with corrections, such as colour or albedo decoded from sRGB. If the mean is 0 only after a
correction, the mistake is found.

Pairs are divided into cells by the brightness of their albedos and by the ratio of these. Then an offset, such as
gloss, does not look like a curve.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from svgf_cl.check.check import Check
from svgf_cl.check.finding import Finding, Unknown, percent
from svgf_cl.check.view import Array, View, Whole, over_channels, sample
from svgf_cl.frame import CARRIED

DARK = 0.02  # an albedo below this is not used
# Where cells begin: by albedo (the first cell begins at 0), and by the logarithm of the ratio of two albedos.
LEVELS, CONTRASTS = (0.15, 0.35), (0.15, 0.4, 0.8)
CELLS = (len(LEVELS) + 1) * len(CONTRASTS)
SAMPLES = 12000  # pixels, each with two neighbours
ENOUGH = 1000  # pairs in a cell
VARIED = 2  # least number of cells: in a single cell an offset looks like a curve
# Limits for the median over cells of the mean of (a - b) / (a + b), as a share of the same for albedo. Up to the first
# it counts as 0. A mistake needs more than the second, and more than the third times the value after the correction.
HOLDS, FAILS, FARTHER = 0.15, 0.25, 2.5
MOST = 0.75  # least share of pairs in cells that a correction improves
DARKER = 0.02  # relative difference from emission that 16-bit floats may cause
SOME = 0.5  # share of the pixels with emission; more than objects that move in a frame can cause
# The fields whose sum, with emission, is color; the relative error of the sum that is allowed; and the share of pixels
# that may exceed it.
PAIRS, ROUNDED, FEW = (("direct", "indirect"), ("diffuse", "specular")), 0.01, 0.01


def srgb_decoded(values: Array) -> Array:
    """Return the linear light of a displayed value, by the curve of IEC 61966-2-1."""
    positive = np.maximum(values, 0)
    return np.where(positive <= 0.04045, positive / 12.92, ((positive + 0.055) / 1.055) ** 2.4)


@dataclass(frozen=True)
class Mistake:
    """A mistake in colour or albedo, and its correction.

    Parameters
    ----------
    field, what, cure : str
    color, albedo : callable
        The corrections of the values of both.
    arranged : str
        How colour is combined with the G-buffer for the correction: ``as given``, ``late`` or ``flipped``.
    """

    field: str
    what: str
    cure: str
    color: Callable[[Array], Array] = np.asarray
    albedo: Callable[[Array], Array] = np.asarray
    arranged: str = "as given"


ENCODED = "encoded for a display: sRGB, gamma or tone-mapped"
LINEAR = "give linear radiance, before any view transform"
MISTAKES = (
    Mistake("albedo", "encoded in sRGB", "decode textures to linear, as the renderer does", albedo=srgb_decoded),
    Mistake("color", ENCODED, LINEAR, color=srgb_decoded),
    Mistake("color", ENCODED, LINEAR, color=lambda color: color / np.maximum(1 - color, 1e-4)),
    Mistake("color", "divided by albedo", "multiply it by albedo again, or leave albedo out", albedo=np.ones_like),
    Mistake("color", "of the previous frame, compared with albedo", "give fields of one frame", arranged="late"),
    Mistake("color", "upside down, compared with albedo", "row 0 must be at the top: flip it", arranged="flipped"),
)
AS_GIVEN = Mistake("", "", "")


def imbalances(before: View, now: View) -> Array | None:
    """Measure pairs of neighbours in cells by albedo and contrast, as given and with every correction.

    Returns
    -------
    (1 + mistakes, 3, CELLS)
        The number of pairs, the sum of (a - b) / (a + b), where a belongs to the greater albedo, and the same sum for
        their albedos.
    """
    if now.albedo is None or before.albedo is None:
        return None
    pairs = {
        "late": lit(before, now.color),  # first, as the cache has the previous frame still
        "as given": lit(now, now.color),
        "flipped": lit(now, now.color[::-1]),
    }
    found = []
    for mistake in (AS_GIVEN, *MISTAKES):
        color, albedo, cell = pairs[mistake.arranged]
        seen, reflectance = mistake.color(color), mistake.albedo(albedo)
        a, b = seen[0] * reflectance[1], seen[1] * reflectance[0]
        weights = np.ones(len(cell)), (a - b) / np.maximum(a + b, 1e-12), (albedo[0] - albedo[1]) / albedo.sum(axis=0)
        found.append([np.bincount(cell, weight, CELLS) for weight in weights])
    return np.array(found)


def lit(view: View, color: Array) -> tuple[Array, Array, Whole]:
    """Return colour and albedo (2, n) of neighbours of which one is lit, and each pair's cell (n)."""
    place, albedo, cell = neighbors(view)
    light = color.ravel()[place]
    told = light.max(axis=0) > 0
    return light[:, told], albedo[:, told], cell[told]


@lru_cache(maxsize=2)  # for a frame and the previous one
def neighbors(view: View) -> tuple[Whole, Array, Whole]:
    """Return neighbours with one normal, the greater albedo first: places and albedo (2, n), and each pair's cell (n).

    Places are indices into the flattened channels.
    """
    assert view.albedo is not None  # `imbalances` has checked it
    width = view.shape[1]
    pixels = sample(view.reflecting, SAMPLES)
    pixels = pixels[
        pixels < view.depth.size - width
    ]  # a pair over a row's end is far apart, so the tests below reject it
    pair = np.concatenate([np.stack([pixels, pixels + step]) for step in (1, width)], axis=1)
    depth = view.depth.ravel()[pair]
    pair = pair[:, view.reflecting.ravel()[pair[1]] & (np.abs(depth[0] - depth[1]) < 0.1 * depth[0])]
    normal = view.normal.reshape(-1, 3).take(pair, axis=0)
    pair = pair[:, np.einsum("nc,nc->n", *normal) > 0.99]
    place = (3 * pair[..., None] + np.arange(3)).reshape(2, -1)
    place = np.where(np.less(*view.albedo.ravel()[place]), place[::-1], place)
    albedo = view.albedo.ravel()[place]
    contrast = np.digitize(np.log(albedo[0] / albedo[1]), CONTRASTS)
    told = (contrast > 0) & (albedo[1] > DARK)
    level = np.digitize(np.sqrt(albedo[0] * albedo[1]), LEVELS)
    return place[:, told], albedo[:, told], (level * len(CONTRASTS) + contrast - 1)[told]


def judge_curve(sums: Array) -> list[Finding | Unknown]:
    """Report the mistake whose correction makes colour proportional to albedo."""
    cells = (sums[:, 0] >= ENOUGH).all(axis=0)
    if np.count_nonzero(cells) < VARIED:
        return [Unknown(CURVE.topic, "albedo hardly changes across surfaces")]
    count, imbalance, contrast = np.moveaxis(sums[..., cells], 1, 0)
    off = np.abs(imbalance) / contrast
    given, *fits = map(weighted_median, off, count)
    # Colour in the wrong place never has more contrast than albedo.
    possible = [mistake.arranged == AS_GIVEN.arranged or imbalance[0].sum() < 0 for mistake in MISTAKES]
    cured = np.where(possible, fits, np.inf)
    best = int(np.argmin(cured))
    mistake, least = MISTAKES[best], cured[best]
    if given <= HOLDS and given < least:
        return [] if max(fits) > FAILS else [Unknown(CURVE.topic, "albedo hardly changes across surfaces")]
    betters = count[0, off[1 + best] < off[0]].sum() > MOST * count[0].sum()
    if not betters or least > HOLDS or given < max(FAILS, FARTHER * least):
        return [Unknown(CURVE.topic, "colour does not follow albedo in a simple way, for example because of gloss")]
    if (
        min(value for other, value in zip(MISTAKES, cured, strict=True) if other.what != mistake.what)
        < 1.5 * least + 0.02
    ):
        return [
            Unknown(
                CURVE.topic,
                f"something is wrong: {mistake.field} may be {mistake.what}, but other mistakes fit as well",
            )
        ]
    measured = (
        f"its contrast between pixels differs from albedo's by {100 * given:.0f} %, "
        f"by {100 * least:.0f} % after the correction"
    )
    return [Finding(mistake.field, mistake.what, measured, mistake.cure)]


def weighted_median(values: Array, weights: Array) -> float:
    """Return the value (n) that has as much weight (n) below it as above it."""
    order = np.argsort(values)
    return float(values[order][np.searchsorted(np.cumsum(weights[order]), 0.5 * weights.sum())])


def shining(view: View) -> Array | None:
    """Count pixels with emission, those darker than their emission, and those of these that are not so after decoding.

    Decoding is from sRGB.
    """
    if view.emission is None:
        return None
    emission, color = (
        values[view.hit & (over_channels(np.maximum, view.emission) > 0)] for values in (view.emission, view.color)
    )
    if not len(emission):
        return None
    least = emission * (1 - DARKER)
    darker = (color < least).any(axis=-1)
    decoded = (srgb_decoded(color) >= least).all(axis=-1)
    return np.array([len(emission), darker.sum(), (darker & decoded).sum()], np.float64)


def judge_shining(sums: Array) -> list[Finding]:
    """Report colour that does not contain emission."""
    pixels, darker, decoded = sums
    if darker <= SOME * pixels:
        return []
    measured = f"in {percent(darker, pixels)} with emission"
    if decoded > 0.9 * darker:
        return [Finding("color", ENCODED, f"darker than emission {measured}, and as bright after decoding", LINEAR)]
    return [Finding("color", "darker than the emission in it", measured, f"{LINEAR}, emission included")]


def unequal(view: View) -> Array | None:
    """Count for each of `PAIRS` its pixels, and those where the sum is not color: (2, pairs)."""
    given = view.frame.present()
    emission = given.get("emission", 0)
    found = np.zeros((2, len(PAIRS)))
    for index, pair in enumerate(PAIRS):
        whole = given["color"] if "color" in given else given["direct"] + given["indirect"] + emission
        if pair[0] in given and pair[1] in given and ("color" in given or pair != PAIRS[0]):
            total = given[pair[0]] + given[pair[1]] + emission
            with np.errstate(invalid="ignore"):  # another check finds values that are not finite
                off = np.abs(total - whole) > ROUNDED * (np.abs(total) + np.abs(whole)) + 1e-6
            found[:, index] = view.frame.depth.size, np.count_nonzero(over_channels(np.logical_or, off))
    return found if found.any() else None


def judge_parts(sums: Array) -> list[Finding]:
    """Report parts of light whose sum is not color."""
    return [
        Finding(
            a,
            f"the sum with {b} and emission is not color",
            f"off by more than {200 * ROUNDED:g} % in {percent(off, pixels)}",
            "split all light of the same samples into the two fields, and put visible lamps and sky into emission",
            "warning" if a in CARRIED else "error",
        )
        for (a, b), pixels, off in zip(PAIRS, *sums, strict=True)
        if off > FEW * pixels
    ]


CURVE = Check(
    "color, albedo: linear",
    imbalances,
    judge_curve,
    "no albedo was given",
    frames=2,
    trusts=("color", "albedo", "normal", "depth"),
)
SHINING = Check("color: contains emission", shining, judge_shining, "nothing emits light", trusts=("color", "emission"))
PARTS = Check(
    "color: the sum of its parts",
    unequal,
    judge_parts,
    "no other parts were given",
    trusts=("color", "emission"),
    fields=tuple(map(" + ".join, PAIRS)),
)
