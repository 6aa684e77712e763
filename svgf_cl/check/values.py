"""Checks single values: not finite, negative, the same everywhere, out of range, or clipped."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from svgf_cl.check.check import Check
from svgf_cl.check.finding import Finding, Unknown, percent
from svgf_cl.check.view import FAR, Array, View, has_normal, in_range, length, over_channels, pixel_centers, typical
from svgf_cl.frame import CARRIED, CHANNELS

FIELDS = tuple(name for name in CHANNELS if name != "id")
POSITIVE = tuple(name for name in FIELDS if name not in ("normal", "depth", "motion"))
# Fields that may be infinite: the depth of a miss, and the length of a ray that left the scene.
ENDLESS = ("depth", "hit_distance")
CONSTANT = ("color", "normal", "depth", "albedo", "id")
OPTIONAL = ("albedo", "id")
# Share of pixels; if there are more, it is no accident.
SOME = 1e-4
UNIT = 0.02  # relative error of a length that 16-bit floats and interpolation may cause


def not_finite(view: View) -> Array:
    """Count for each of `FIELDS` its pixels, and those with NaN or infinity: (2, F)."""
    found = np.zeros((2, len(FIELDS)))
    for index, name in enumerate(FIELDS):
        values = getattr(view.frame, name)
        if values is not None:
            bad = np.isnan(values) | (values == -np.inf) if name in ENDLESS else ~np.isfinite(values)
            found[:, index] = view.frame.depth.size, np.count_nonzero(any_channel(bad))
    return found


def any_channel(mask: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return whether any channel of a pixel is set: (H, W) from (H, W) or (H, W, C)."""
    return over_channels(np.logical_or, np.atleast_3d(mask))


def judge_finite(sums: Array) -> list[Finding]:
    """Report NaN, and infinity except in `ENDLESS`."""
    cure = "the pixels are dropped; look for divisions by 0 and paths of probability 0"
    return [
        Finding(
            name,
            "NaN or infinity",
            percent(count, pixels),
            cure,
            "error" if count > 0.01 * pixels and name not in CARRIED else "warning",
        )
        for name, pixels, count in zip(FIELDS, *sums, strict=True)
        if count
    ]


def negative(view: View) -> Array:
    """Count for each of `POSITIVE` its pixels, and those with a clearly negative channel: (2, F)."""
    found = np.zeros((2, len(POSITIVE)))
    for index, name in enumerate(POSITIVE):
        values = getattr(view.frame, name)
        if values is not None:
            below = np.zeros_like(values, np.bool_)
            if (values < 0).any():  # else the mean, which is slow, is not needed
                finite = np.nan_to_num(values, posinf=0, neginf=0)
                below = finite < -1e-3 * np.abs(finite).mean(dtype=np.float64)
            found[:, index] = view.frame.depth.size, np.count_nonzero(any_channel(below))
    return found


def judge_negative(sums: Array) -> list[Finding]:
    """Report light, reflectance, roughness and lengths below 0."""
    cure = "give the samples before pixel filters with negative lobes and before colour conversions"
    return [
        Finding(name, "negative", percent(count, pixels), cure, "warning" if name in CARRIED else "error")
        for name, pixels, count in zip(POSITIVE, *sums, strict=True)
        if count
    ]


def constant(view: View) -> Array | None:
    """Count for each of `CONSTANT` the frames that have it, and those where all hits have one value."""
    if np.count_nonzero(view.hit) < 2:
        return None
    given = {name: values for name in CONSTANT if (values := getattr(view, name)) is not None}
    first = np.unravel_index(np.argmax(view.hit), view.shape)
    same = {name: not (view.hit & any_channel(values != values[first])).any() for name, values in given.items()}
    if same["normal"] and on_a_plane(view):  # a picture of a single wall
        same["normal"] = same["depth"] = False
    there = [getattr(view.frame, name) is not None for name in CONSTANT]
    return np.array([there, [same.get(name, False) for name in CONSTANT]], np.float64)


def on_a_plane(view: View) -> bool:
    """Whether all hits lie on one plane, by their depth."""
    x, y = (axis[view.hit] for axis in pixel_centers(view.shape))
    nearness, columns = view.nearness[view.hit], np.stack([x, y, np.ones_like(x)], axis=-1)
    off = nearness - columns @ np.linalg.lstsq(columns, nearness, rcond=None)[0]
    return bool(np.abs(off).max() < 1e-3 * nearness.mean())


def judge_constant(sums: Array) -> list[Finding]:
    """Report fields that have one value everywhere: they are placeholders."""
    return [
        Finding(
            name,
            "one value everywhere",
            f"in {count:g} of {sums[0].max():g} frames",
            "leave this field out, or give each pixel its own value"
            if name in OPTIONAL
            else "give each pixel its own value",
            "warning" if name in OPTIONAL else "error",
        )
        for name, count in zip(CONSTANT, sums[1], strict=True)
        if count > 0.5 * sums[0].max()
    ]


def lengths(view: View) -> Array | None:
    """Count pixels with a depth, and those whose normal has unit length, unit length after decoding, length 0, or more.

    Decoding is from 0..1.
    """
    normal = view.normal[(view.depth > 0) & (view.depth < view.depth.max())]  # the greatest depth may mean a miss
    own, decoded = length(normal), length(2 * normal - 1)
    encoded = (np.abs(decoded - 1) < UNIT) & (over_channels(np.minimum, normal) >= 0)
    counts = (np.abs(own - 1) < UNIT, encoded, own < 1e-6, own > 1 + UNIT)
    return np.array([len(normal), *map(np.count_nonzero, counts)], np.float64) if len(normal) else None


def judge_lengths(sums: Array) -> list[Finding]:
    """Report normals that are no unit vectors where something was hit."""
    hit, unit, encoded, zero, long = sums
    if encoded > 0.9 * hit and unit < 0.5 * hit:
        measured = f"2 n - 1 has unit length in {percent(encoded, hit)}, n in {percent(unit, hit)}"
        return [Finding("normal", "encoded in 0..1", measured, "give 2 n - 1, and 0 where the ray hit nothing")]
    if zero > 1e-3 * hit:
        cure = "give every surface its shading normal, and depth +inf where there is no surface"
        return [Finding("normal", "zero where there is a depth", f"in {percent(zero, hit)}", cure)]
    # The mean of several samples is shorter, at edges and out of focus, but it is never longer.
    if long > 0.01 * hit or unit < 0.1 * hit:
        measured = f"off by more than {100 * UNIT:g} % in {percent(hit - unit, hit)}"
        return [Finding("normal", "not of unit length", measured, "normalise after interpolating or transforming")]
    return []


def misses(view: View) -> Array:
    """Count pixels, and those with a normal whose depth is below 0, 0, or a finite number that must mean a miss.

    Without a normal, the denoiser treats all these as misses.
    """
    depth, seen = view.frame.depth, has_normal(view.frame.normal)
    hit = seen & in_range(depth)
    number = hit & (depth > FAR * typical(depth[hit]))
    return np.array([depth.size, *map(np.count_nonzero, (seen & (depth < 0), seen & (depth == 0), number))], np.float64)


def judge_misses(sums: Array) -> list[Finding]:
    """Report depth that is not above 0, or finite where nothing was hit."""
    pixels, *bad = sums
    mistakes = (
        ("negative", "negate the z of a camera that looks along -z"),
        ("0 where there is a normal", "give the distance, and +inf where the ray hit nothing"),
        ("a finite number where the ray hit nothing", "give +inf there"),
    )
    return [
        Finding("depth", what, f"in {percent(count, pixels)}", cure)
        for (what, cure), count in zip(mistakes, bad, strict=True)
        if count > 1e-3 * pixels
    ]


def hits(view: View) -> Array:
    """Count pixels where the denoiser sees a surface, and those that have a normal."""
    seen = has_normal(view.frame.normal)
    return np.array([np.count_nonzero(seen & in_range(view.frame.depth)), np.count_nonzero(seen)], np.float64)


def judge_hits(sums: Array) -> list[Finding | Unknown]:
    """Report frames without any usable depth: nothing is filtered there."""
    hit, normals = sums
    if hit:
        return []
    if not normals:
        return [Unknown(SEEN.topic, "the rays hit nothing, so pictures are not filtered")]
    measured = f"no depth is usable in any of {normals:g} pixels with a normal"
    return [Finding("depth", "empty everywhere", measured, "give the pass that has the distance")]


def above_one(view: View) -> Array | None:
    """Count pixels, and those whose albedo is above 1."""
    if view.albedo is None:
        return None
    return np.array([view.depth.size, np.count_nonzero(over_channels(np.maximum, view.albedo) > 1.01)], np.float64)


def judge_albedo(sums: Array) -> list[Finding]:
    """Report albedo above 1: no surface reflects more light than it gets."""
    if sums[1] <= SOME * sums[0]:
        return []
    cure = "give lamps and sky an albedo of 1 and put their light into emission; divide 8-bit albedo by 255"
    return [Finding("albedo", "above 1, as if it held emitted light", percent(sums[1], sums[0]), cure)]


def beyond_rough(view: View) -> Array | None:
    """Count pixels, and those whose roughness is above 1."""
    roughness = view.frame.roughness
    return None if roughness is None else np.array([roughness.size, np.count_nonzero(roughness > 1.001)], np.float64)


def judge_roughness(sums: Array) -> list[Finding]:
    """Report roughness above 1."""
    if sums[1] <= SOME * sums[0]:
        return []
    cure = "divide 8-bit roughness by 255; the exponent of a lobe is not a roughness"
    return [Finding("roughness", "above 1", percent(sums[1], sums[0]), cure, "warning")]


def at_one(view: View) -> Array:
    """Count pixels of surfaces, those with a channel of exactly 1, and those with a channel above 1."""
    color = view.color[view.hit]
    return np.array([len(color), any_channel(color == 1).sum(), any_channel(color > 1).sum()], np.float64)


def judge_range(sums: Array) -> list[Finding | Unknown]:
    """Report clipped colour: many values of exactly 1, and none above."""
    pixels, one, above = sums
    if above:
        return []
    if one <= SOME * pixels:
        return [Unknown(RANGE.topic, "no radiance is above 1, which may be so in a dim scene")]
    measured = f"a channel is exactly 1 in {percent(one, pixels)}, none is above"
    return [Finding("color", "clipped to 0..1", measured, "store float radiance, before exposure and view transform")]


FINITE = Check("every field: finite", not_finite, judge_finite, fields=FIELDS)
NEGATIVE = Check("light, reflectance, lengths: not negative", negative, judge_negative, fields=POSITIVE)
FILLED = Check("surfaces: not one value everywhere", constant, judge_constant, "nothing was hit", fields=CONSTANT)
LENGTH = Check(
    "normal: unit vectors", lengths, judge_lengths, "depth is the same everywhere", trusts=("normal", "depth")
)
MISSES = Check("depth: in range where there is a normal", misses, judge_misses)
SEEN = Check("depth: not empty", hits, judge_hits, trusts=("depth",))
ALBEDO = Check("albedo: 0 to 1", above_one, judge_albedo, "no albedo was given")
ROUGHNESS = Check("roughness: 0 to 1", beyond_rough, judge_roughness, "no roughness was given")
RANGE = Check("color: not clipped", at_one, judge_range, trusts=("color",))
