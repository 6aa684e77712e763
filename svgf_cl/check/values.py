"""What single numbers tell: not finite, negative, one value everywhere, out of range, clipped."""

from __future__ import annotations

import numpy as np

from svgf_cl.check.check import Check
from svgf_cl.check.finding import EXPECTED, Finding, Unknown, percent
from svgf_cl.check.view import FAR, Array, View, pixel_centers, typical

FIELDS = tuple(name for name in EXPECTED if name != "id")
COLORS = ("color", "albedo", "emission", "direct", "indirect")
CONSTANT = ("color", "normal", "depth", "albedo", "id")
OPTIONAL = ("albedo", "id")
# Pixels enough to tell a rule of the renderer from its accident.
SOME = 1e-4
UNIT = 0.02  # of a length: what half floats and interpolation leave


def not_finite(view: View) -> Array:
    """All pixels; those of each of `FIELDS` that hold NaN or infinity."""
    counts: dict[str, int] = dict.fromkeys(FIELDS, 0)
    for name in FIELDS & view.frame.present().keys():
        values = getattr(view.frame, name).reshape(view.frame.depth.size, -1)
        bad = np.isnan(values) | (values == -np.inf) if name == "depth" else ~np.isfinite(values)
        counts[name] = int(np.count_nonzero(bad.any(axis=-1)))
    return np.array([view.frame.depth.size, *counts.values()], np.float64)


def judge_finite(sums: Array) -> list[Finding]:
    """Nothing may be infinite but the depth of a miss."""
    cure = "the pixels are dropped; look for divisions by 0 and paths of probability 0"
    return [
        Finding(
            name, "NaN or infinity", percent(count, sums[0]), cure, "error" if count > 0.01 * sums[0] else "warning"
        )
        for name, count in zip(FIELDS, sums[1:], strict=True)
        if count
    ]


def negative(view: View) -> Array:
    """All pixels; those of each of `COLORS` with a clearly negative channel."""
    counts: dict[str, int] = dict.fromkeys(COLORS, 0)
    for name in COLORS & view.frame.present().keys():
        values = np.nan_to_num(getattr(view.frame, name))
        counts[name] = int((values < -1e-3 * np.abs(values).mean(dtype=np.float64)).any(axis=-1).sum())
    return np.array([view.frame.depth.size, *counts.values()], np.float64)


def judge_negative(sums: Array) -> list[Finding]:
    """Light and reflectance are never below 0."""
    cure = "hand over what was sampled, before pixel filters with negative lobes and conversions of colour"
    return [
        Finding(name, "negative", percent(count, sums[0]), cure)
        for name, count in zip(COLORS, sums[1:], strict=True)
        if count
    ]


def constant(view: View) -> Array | None:
    """Frames; those in which each of `CONSTANT` is one value wherever something was hit."""
    if np.count_nonzero(view.hit) < 2:
        return None
    inside = {name: values[view.hit] for name in CONSTANT if (values := getattr(view, name)) is not None}
    same = {name: bool((values == values[0]).all()) for name, values in inside.items()}
    if same["normal"] and on_a_plane(view):  # a picture of a single wall
        same["normal"] = same["depth"] = False
    return np.array([True, *(same.get(name, False) for name in CONSTANT)], np.float64)


def on_a_plane(view: View) -> bool:
    """Whether all that was hit lies on one plane, as far as depth can tell."""
    x, y = (axis[view.hit] for axis in pixel_centers(view.shape))
    nearness, columns = view.nearness[view.hit], np.stack([x, y, np.ones_like(x)], axis=-1)
    off = nearness - columns @ np.linalg.lstsq(columns, nearness, rcond=None)[0]
    return bool(np.abs(off).max() < 1e-3 * nearness.mean())


def judge_constant(sums: Array) -> list[Finding]:
    """A field that is the same everywhere is a placeholder."""
    return [
        Finding(
            name,
            "one value everywhere",
            f"in {count:g} of {sums[0]:g} frames",
            "leave it out, or hand over what each pixel shows"
            if name in OPTIONAL
            else "hand over what each pixel shows",
            "warning" if name in OPTIONAL else "error",
        )
        for name, count in zip(CONSTANT, sums[1:], strict=True)
        if count > 0.5 * sums[0]
    ]


def lengths(view: View) -> Array | None:
    """Pixels with a depth; those of unit length, of unit length once decoded from 0..1, of length 0, too long."""
    normal = view.normal[(view.depth > 0) & (view.depth < view.depth.max())]  # the greatest depth may stand for a miss
    length, decoded = np.linalg.norm(normal, axis=-1), np.linalg.norm(2 * normal - 1, axis=-1)
    encoded = (np.abs(decoded - 1) < UNIT) & (normal.min(axis=-1, initial=1) >= 0)
    counts = (np.abs(length - 1) < UNIT, encoded, length < 1e-6, length > 1 + UNIT)
    return np.array([len(normal), *map(np.count_nonzero, counts)], np.float64) if len(normal) else None


def judge_lengths(sums: Array) -> list[Finding]:
    """Normals are unit vectors where something was hit."""
    hit, unit, encoded, zero, long = sums
    if encoded > 0.9 * hit and unit < 0.5 * hit:
        measured = f"2 n - 1 has unit length in {percent(encoded, hit)}, n in {percent(unit, hit)}"
        return [Finding("normal", "encoded in 0..1", measured, "give 2 n - 1, and 0 where nothing was hit")]
    if zero > 1e-3 * hit:
        cure = "give every surface its shading normal, and +inf as depth to what is none"
        return [Finding("normal", "zero where there is a depth", f"in {percent(zero, hit)}", cure)]
    # The mean of several samples is shorter, along edges and out of focus; nothing makes it longer.
    if long > 0.01 * hit or unit < 0.1 * hit:
        measured = f"off by more than {100 * UNIT:g} % in {percent(hit - unit, hit)}"
        return [Finding("normal", "not of unit length", measured, "normalise after interpolating or transforming")]
    return []


def misses(view: View) -> Array:
    """Pixels; of depth below 0; of depth 0; of a finite depth that stands for a miss."""
    depth = view.frame.depth
    usable = np.isfinite(depth) & (depth > 0)
    unseen = ~view.frame.normal.any(axis=-1) & (depth == depth[usable].max(initial=0))
    number = usable & (unseen | (depth > FAR * typical(depth[usable])))
    return np.array([depth.size, *map(np.count_nonzero, (depth < 0, depth == 0, number))], np.float64)


def judge_misses(sums: Array) -> list[Finding]:
    """Depth is above 0, and +inf where nothing was hit."""
    pixels, *bad = sums
    mistakes = (
        ("negative", "negate the z of a camera that looks along -z"),
        ("0 where nothing was hit", "give +inf there"),
        ("a finite number where nothing was hit", "give +inf there"),
    )
    return [
        Finding("depth", what, f"in {percent(count, pixels)}", cure)
        for (what, cure), count in zip(mistakes, bad, strict=True)
        if count > 1e-3 * pixels
    ]


def above_one(view: View) -> Array | None:
    """Pixels, and those whose albedo is above 1."""
    if view.albedo is None:
        return None
    return np.array([view.depth.size, np.count_nonzero(view.albedo.max(axis=-1) > 1.01)], np.float64)


def judge_albedo(sums: Array) -> list[Finding]:
    """No surface reflects more light than it gets."""
    if sums[1] <= SOME * sums[0]:
        return []
    cure = "give lamps and sky an albedo of 1 and put what they shine into emission; divide 8-bit albedo by 255"
    return [Finding("albedo", "above 1, as if it held emitted light", percent(sums[1], sums[0]), cure)]


def at_one(view: View) -> Array:
    """Pixels of surfaces; with a channel of exactly 1; with one above."""
    color = view.color[view.hit]
    return np.array([len(color), (color == 1).any(axis=-1).sum(), (color > 1).any(axis=-1).sum()], np.float64)


def judge_range(sums: Array) -> list[Finding | Unknown]:
    """Many values of exactly 1 and none above are no accident."""
    pixels, one, above = sums
    if above:
        return []
    if one <= SOME * pixels:
        return [Unknown(RANGE.topic, "no radiance is above 1, as in any dim scene")]
    measured = f"a channel is exactly 1 in {percent(one, pixels)}, none is above"
    return [Finding("color", "clipped to 0..1", measured, "store float radiance, before exposure and view transform")]


FINITE = Check("every field: finite", not_finite, judge_finite)
NEGATIVE = Check("colours: not negative", negative, judge_negative)
FILLED = Check("every field: not one value everywhere", constant, judge_constant, "nothing was hit")
LENGTH = Check("normal: unit vectors", lengths, judge_lengths, "nothing was hit", trusts=("normal", "depth"))
MISSES = Check("depth: above 0, +inf where nothing was hit", misses, judge_misses)
ALBEDO = Check("albedo: 0 to 1", above_one, judge_albedo, "no albedo was given")
RANGE = Check("color: not clipped", at_one, judge_range, trusts=("color",))
