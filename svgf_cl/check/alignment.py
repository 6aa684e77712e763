"""Checks that the fields of the G-buffer have their edges in the same places.

The edges of a field correlate with those of the others. If a field is upside down, its edges correlate more with the
others' mirror image; if it belongs to another frame, more with the others of that frame.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from svgf_cl.check.check import Check
from svgf_cl.check.finding import Finding, Unknown
from svgf_cl.check.view import Array, View, beside, over_channels

FIELDS = ("depth", "normal", "albedo", "id", "motion")
# Least second differences between neighbours at an edge: relative ones of one over depth, and of motion compared with
# the fastest; absolute ones of components of normals, and of channels of albedo.
NEARNESS, MOTION, NORMAL, ALBEDO = 0.05, 0.02, 0.2, 0.1
MOVING = 0.01  # pixels; if the fastest motion is less, motion has no edges
CLEARLY = 1.1  # the correlation must be higher by this factor
CERTAIN = 0.03  # and by this amount
ENOUGH = 2e-3  # share of pixels on edges


@lru_cache(maxsize=2)  # for a frame and the previous one
def edges(view: View) -> dict[str, Array]:
    """Return the edges of each field, (h, w): 0 or 1."""
    if view.is_small:
        return {}
    found: dict[str, NDArray[np.generic]] = {
        "depth": bend(view.nearness) > NEARNESS * view.nearness,
        "normal": bend(view.normal) > NORMAL,
    }
    if view.albedo is not None:
        found["albedo"] = bend(view.albedo) > ALBEDO
    if view.id is not None:
        found["id"] = np.logical_or(*(view.id != beside(view.id, axis)[1] for axis in (0, 1)))
    fastest = float(np.percentile(np.abs(view.motion), 99))
    if fastest > MOVING:
        found["motion"] = bend(view.motion) > MOTION * fastest
    return {name: values.astype(np.float64) for name, values in found.items() if values.mean() > ENOUGH}


def bend(values: Array) -> Array:
    """Return the largest second difference at each pixel (h, w) of (h, w, ...), over both axes and all channels."""
    both = [np.abs(np.add(*beside(values, axis)) - 2 * values) for axis in (0, 1)]
    return over_channels(np.maximum, np.atleast_3d(np.maximum(*both)))


def correlations(first: dict[str, Array], second: dict[str, Array]) -> Array:
    """Return the correlation of each field's edges in the first frame with the other fields' edges in the second, (F).

    It is 0 where there are no edges.
    """
    found = np.zeros(len(FIELDS))
    if first and second:
        a, b = (np.stack([edge.ravel() for edge in fields.values()]) for fields in (first, second))
        own, both, within = (covariances(*pair) for pair in ((a, a), (a, b), (b, b)))
        for row, name in enumerate(first):
            others = np.array([other != name for other in second])
            spread = np.sqrt(own[row, row] * within[np.ix_(others, others)].sum())
            found[FIELDS.index(name)] = np.nan_to_num(both[row, others].sum() / spread)
    return found


def covariances(a: Array, b: Array) -> Array:
    """Return the covariance of each row of `a` (M, n) with each of `b` (N, n), times n: (M, N)."""
    together: Array = a @ b.T - np.outer(a.sum(axis=1), b.mean(axis=1))
    return together


def mirrored(view: View) -> Array:
    """Return which fields have correlations, these, and the correlations with the others upside down: (3, F)."""
    now = edges(view)
    here = correlations(now, now)
    return np.array([here != 0, here, correlations(now, {name: values[::-1] for name, values in now.items()})])


def displaced(before: View, now: View) -> Array:
    """Return which fields have correlations, these, and those with the previous and next frame's others: (4, F)."""
    old, new = edges(before), edges(now)
    here = correlations(new, new)
    return np.array([here != 0, here, correlations(new, old), correlations(old, new)])


def judged(sums: Array, topic: str, why: str, mistakes: tuple[tuple[str, str], ...]) -> list[Finding | Unknown]:
    """Report a mistake if the edges of a field match those of the others clearly better after the correction."""
    findings: list[Finding | Unknown] = []
    alike = []
    for name, (frames, as_is, *others) in zip(FIELDS, sums.T, strict=True):
        here, there = max(as_is, 0) / max(frames, 1), max(*others, 0) / max(frames, 1)
        if there > CLEARLY * here + CERTAIN:
            what, cure = mistakes[int(np.argmax(others))]
            measured = (
                f"its edges correlate with those of the other fields by {there:.2f} if corrected, {here:.2f} as given"
            )
            findings.append(Finding(name, what, measured, cure))
        elif frames and not here > CLEARLY * there + CERTAIN:
            alike.append(name)
    if findings or (sums[0].any() and not alike):
        return findings
    return [Unknown(topic, f"{why}: {', '.join(alike) or 'no field has enough edges'}")]


def judge_mirrored(sums: Array) -> list[Finding | Unknown]:
    """Report fields that match the mirror images of the others: they are upside down."""
    cure = "row 0 must be at the top of every field: flip the rows of fields from a graphics API's buffer"
    return judged(
        sums,
        UPRIGHT.topic,
        "too similar to their mirror images",
        (("upside down, compared with the other fields", cure),),
    )


def judge_displaced(sums: Array) -> list[Finding | Unknown]:
    """Report fields that match the others of another frame: they are late or early."""
    cure = "give fields of one frame; perhaps a buffer is read before it is written"
    mistakes = (
        ("of the previous frame, compared with the other fields", cure),
        ("of the next frame, compared with the other fields", cure),
    )
    return judged(sums, PUNCTUAL.topic, "no edges that move by a pixel", mistakes)


UPRIGHT = Check("G-buffer: the same way up", mirrored, judge_mirrored, fields=FIELDS)
PUNCTUAL = Check("G-buffer: of the same frame", displaced, judge_displaced, frames=2, trusts=FIELDS, fields=FIELDS)
