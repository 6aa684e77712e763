"""Checks that a surface keeps its id and its normal from one frame to the next, and that its depth changes as given.

Motion leads to the pixels that show the same surface in both frames; their depth confirms it.
"""

from __future__ import annotations

from functools import lru_cache, reduce

import numpy as np

from svgf_cl.check.camera import path
from svgf_cl.check.check import Check
from svgf_cl.check.finding import Finding, Unknown, percent
from svgf_cl.check.view import Array, Mask, View, Whole, beside, length, over_channels, sample
from svgf_cl.filters import Settings

EDGE = 0.1  # least relative difference of depth between two surfaces
ENOUGH = 300  # pixels
SAMPLES = 3000
KEPT = 5e-4  # greatest distance between normals that are the same
TURNED = 2e-3  # radians: least turn of a camera that is visible in normals
FLAT = 1e-4  # greatest difference of normals between neighbours on a plane
BETTER = 0.8  # an error smaller by this factor is clearly better


@lru_cache(maxsize=1)  # several checks need it for the same pair
def followed(before: View, now: View) -> tuple[Mask, tuple[Whole, Whole]]:
    """Return the pixels (h, w) whose surface the previous frame shows too, and its rows and columns there (n)."""
    height, width = now.shape
    y, x = np.indices(now.shape)
    columns, rows = (np.rint(p + now.motion[..., axis]) for axis, p in enumerate((x, y)))
    inside = (columns >= 0) & (columns < width) & (rows >= 0) & (rows < height)
    there = tuple(np.where(inside, p, 0).astype(int) for p in (rows, columns))
    same = inside & interior(before)[there] & interior(now)  # in this order, the cache has the previous frame still
    same &= np.abs(now.depth * before.nearness[there] - 1) < EDGE
    return same, (there[0][same], there[1][same])


@lru_cache(maxsize=2)  # for a frame and the previous one
def interior(view: View) -> Mask:
    """Return the pixels without an edge of depth within two pixels."""
    least = most = view.nearness
    for axis in (0, 1):
        least, most = (reduce(choose, beside(v, axis, 2), v) for choose, v in ((np.minimum, least), (np.maximum, most)))
    smooth: Mask = view.hit & (most - least < EDGE * view.nearness)
    return smooth


def names(before: View, now: View) -> Array | None:
    """Count pixels found in the previous frame, those with the same id there, and those with their object's main id."""
    if now.id is None or before.id is None:
        return None
    if now.is_small:
        return np.zeros(3)
    same, there = followed(before, now)
    ids, past = now.id[same], before.id[there]
    pairs, counts = np.unique(ids << 32 | past, return_counts=True)
    objects = np.flatnonzero(np.diff(pairs >> 32, prepend=-1))
    together = np.maximum.reduceat(counts, objects).sum() if len(ids) else 0
    return np.array([len(ids), np.count_nonzero(ids == past), together], np.float64)


def judge_names(sums: Array) -> list[Finding | Unknown]:
    """Report objects whose pixels stay together but change their id: they were renumbered."""
    found, kept, together = sums
    if found < ENOUGH:
        return [Unknown(NAMES.topic, "too few surfaces are visible in the previous frame, too")]
    measured = f"{percent(found - kept, found)} that show the same surface as in the previous frame have another id"
    if together - kept > 0.05 * found:
        cure = "number objects once for the whole sequence, not by their order in a frame"
        return [Finding("id", "the same object changes its id between frames", measured, cure)]
    if kept < 0.7 * found:
        return [Finding("id", "changes from pixel to pixel", measured, "give objects ids, not triangles or samples")]
    return []


def turns(before: View, now: View) -> Array | None:
    """Count pixels on planes that are in both frames: all, those with the same normal, those that turn together.

    The last value says whether the camera turns.
    """
    same, there = followed(before, now)
    bends = [over_channels(np.maximum, np.abs(beside(now.normal, axis)[1] - now.normal)) for axis in (0, 1)]
    plane = sample((np.maximum(*bends) < FLAT)[same] & before.hit[there], SAMPLES)
    normal, past = now.normal[same][plane], before.normal[there][plane]
    if len(normal) < ENOUGH:
        return None
    apart = length(normal - past)
    left = length(normal @ rotation_between(normal, past).T - past)
    alike = (apart > KEPT) & (left < 0.25 * apart)
    camera = path(now)
    turned = camera is not None and camera.turn(now.shape[0]) > TURNED
    return np.array([len(normal), np.count_nonzero(apart <= KEPT), np.count_nonzero(alike), turned], np.float64)


def rotation_between(normal: Array, past: Array) -> Array:
    """Return the rotation (3, 3) from most normals (n, 3) to their past ones: Kabsch's method, with weights by fit."""
    weight = np.ones(len(normal))
    for _ in range(8):
        u, _, v = np.linalg.svd((past * weight[:, None]).T @ normal)
        rotation: Array = u @ v
        off = length(past - normal @ rotation.T)
        weight = 1 / (1 + (off / max(float(np.median(off)), 1e-5)) ** 2)
    return rotation


def judge_turns(sums: Array) -> list[Finding | Unknown]:
    """Report normals in view space: most of them turn together, with the camera."""
    found, kept, alike, turned = sums
    if alike > 0.6 * found:
        measured = f"they turn together from frame to frame in {percent(alike, found)} on planes"
        return [Finding("normal", "in view space", measured, "multiply by the rotation from camera to world")]
    if turned and kept > 0.5 * found:
        return []
    why = "the camera does not turn" if kept > 0.5 * found else "too few planes are visible in both frames"
    return [Unknown(WORLD.topic, why)]


def deeper(before: View, now: View) -> Array | None:
    """Measure motion's third component on surfaces that are in both frames.

    Returns
    -------
    (8,) or None
        The number of pixels; whether there is a third component; the number of pixels that lose their history without
        it, and with it; and the error of each interpretation as a share of depth: none, as given, negated, and the
        previous depth itself.
    """
    same, there = followed(before, now)
    if not same.any():
        return None
    depth = now.depth[same]
    change = before.depth[there] / depth - 1
    given = np.zeros_like(depth) if now.deeper is None else now.deeper[same] / depth
    off = np.abs(np.stack([0 * given, given, -given, given - 1]) - change)
    lost = np.count_nonzero(off[:2] > Settings().depth_threshold, axis=-1)
    return np.array([len(depth), now.deeper is not None, *lost, *np.minimum(off, EDGE).sum(axis=-1)])


def judge_deeper(sums: Array) -> list[Finding | Unknown]:
    """Report the interpretation that is nearest to the actual change of depth, if it is not the right one."""
    found, there, lost, refused, none, given, negated, absolute = sums
    if not there:
        if lost < 0.5 * found:
            return [Unknown(DEEPER.topic, "it was not given, and depth changes little")]
        measured = f"depth changes by more than {100 * Settings().depth_threshold:g} % in {percent(lost, found)}"
        return [Finding("motion", "without third component", measured, "give previous minus current depth", "warning")]
    wrong = {
        negated: ("third component of the wrong sign", "negate it"),
        absolute: ("third component is the previous depth itself", "subtract the current depth"),
    }
    best = min(wrong)
    if best < BETTER * min(given, none):
        what, cure = wrong[best]
        measured = (
            f"the expected previous depth is wrong by {100 * given / found:.2g} %, "
            f"by {100 * best / found:.2g} % after the correction"
        )
        return [Finding("motion", what, measured, cure)]
    if refused > 0.5 * found and none < BETTER * given:
        measured = f"with it {percent(refused, found)} lose their history, without it {percent(lost, found)}"
        cure = (
            "give previous minus current depth, or only two components; "
            "in a vector pass with four, the third is another motion"
        )
        return [Finding("motion", "third component is not the change of depth", measured, cure)]
    return [] if given < BETTER * min(none, negated) else [Unknown(DEEPER.topic, "depth does not change noticeably")]


NAMES = Check("id: kept by objects", names, judge_names, "no id was given", frames=2, trusts=("depth", "motion"))
WORLD = Check(
    "normal: in world space",
    turns,
    judge_turns,
    "too few planes are visible in both frames",
    frames=2,
    trusts=("normal", "depth", "motion"),
)
DEEPER = Check(
    "motion: third component",
    deeper,
    judge_deeper,
    "no surface is visible in both frames",
    frames=2,
    trusts=("depth", "motion"),
)
