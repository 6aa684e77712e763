"""Checks that depth is the distance along the camera's axis, by the shape of planes.

On a plane seen in perspective, one over the distance along the axis is affine in x and y: of three pixels in a row, the
middle one has the mean of both ends. For triples of pixels with the same normal, this is tested with the given depth,
and with each correction of a mistake. Each triple votes for the version that is clearly the straightest.
"""

from __future__ import annotations

import numpy as np

from svgf_cl.check.check import Check
from svgf_cl.check.finding import Finding, Unknown
from svgf_cl.check.view import Array, View, Whole, over_channels, pixel_centers, sample

SAMPLES = 10000  # pixels that may lie on planes
REACH = 1 / 30  # of the image's height, from the middle pixel to both others
SAME = 1e-3  # greatest difference between components of normals on one plane
PRECISION = 2e-6  # relative error of depth by rounding
CLEARLY = 0.3  # the smaller error is less than this share of the other
ENOUGH = 50  # votes
FLAT = 3e-3  # of depth: three pixels that vary less are practically at one distance
ONE_WAY = 0.9  # if the mean normal is longer than this, all planes may face the camera
FOCAL_LENGTHS = np.geomspace(0.3, 4.0, 16)  # in image heights, for depth along the ray

NOT_LINEAR = (
    "not linear: a depth buffer, or one over the distance",
    "convert: near far / (far - d (far - near)) if 0 is near and 1 is far; 1 / d if d is one over the distance",
)
MISTAKES = (
    NOT_LINEAR,  # depth itself is affine
    ("does not begin at the camera: scaled between near and far plane", "convert: near + d (far - near)"),
    ("inverted: it falls with the distance", "convert: far - d if d is far - z"),
    *[("measured along the ray", "multiply by the cosine between the ray and the camera's axis")] * len(FOCAL_LENGTHS),
    NOT_LINEAR,  # all depths are almost equal, as in a buffer whose near plane is very near: the last choice
)


def votes(view: View) -> Array | None:
    """Return the votes for and against each of `MISTAKES`: (2, mistakes)."""
    pixels = triples(view)
    if len(pixels) < ENOUGH:
        return None
    depth, x, y = (values.ravel()[pixels.T] for values in (view.depth, *pixel_centers(view.shape)))
    middle = depth[1]
    nearness = 1 / depth
    given = error(nearness, middle)
    offset = origin(depth)
    beyond = np.where(depth == offset, np.nan, depth - offset)
    moved = np.nan_to_num(error(1 / beyond, beyond[1] ** 2 / middle), nan=np.inf)
    oblique = np.sqrt(1 + (x**2 + y**2) / (FOCAL_LENGTHS[:, None, None] * view.shape[0]) ** 2)
    neither = np.full(len(pixels), np.inf)
    errors = np.stack(
        [
            error(depth, 1 / middle),
            moved if offset < 0 else neither,
            moved if offset > 0 else neither,
            *(error(o * nearness, middle / o[1]) for o in oblique),
            neither,
        ]
    )
    wins = (errors <= errors.min(axis=0)) & (errors < CLEARLY * given)
    losses = given < CLEARLY * errors
    tilted = np.linalg.norm(view.normal.reshape(-1, 3)[pixels[:, 1]].mean(axis=0)) < ONE_WAY
    wins[-1] = (np.ptp(depth, axis=0) < FLAT * middle) & (depth.max() <= 1) & tilted
    losses[-1] = ~wins[-1]
    return np.array([wins.sum(axis=1), losses.sum(axis=1)], np.float64)


def triples(view: View) -> Whole:
    """Return triples of pixels in a row on one plane, as indices into the flattened image: (n, 3)."""
    (height, width), reach = view.shape, max(round(REACH * view.shape[0]), 2)
    found = []
    for dx, dy in ((reach, 0), (0, reach)):
        middle = np.zeros(view.shape, np.bool_)
        middle[dy : height - dy, dx : width - dx] = True
        pixels = sample(middle & view.hit, SAMPLES)[:, None] + np.array([-1, 0, 1]) * (dy * width + dx)
        normal, hit = view.normal.reshape(-1, 3)[pixels.T], view.hit.ravel()[pixels.T].all(axis=0)
        found.append(pixels[hit & (over_channels(np.maximum, np.ptp(normal, axis=0)) < SAME)])
    return np.concatenate(found)


def error(values: Array, sensitivity: Array) -> Array:
    """Return how far the middle of three values (3, n) is from the mean of both ends: (n), as relative depth.

    The values are functions of depth. `sensitivity` (n) is the relative change of depth if the middle one changes by 1.
    """
    bend = values[0] + values[2] - 2 * values[1]
    off: Array = np.maximum(np.abs(bend * sensitivity), PRECISION)
    return off


def origin(depth: Array) -> float:
    """Return the c for which 1 / (depth - c) is affine in most triples (3, n); 0 if depth itself is the distance.

    1 / (value - c) is affine in a, b, d if c (a + d - 2 b) = 2 a d - b (a + d).
    """
    a, b, d = depth
    curved, product = a + d - 2 * b, 2 * a * d - b * (a + d)
    told = np.abs(curved) > 10 * PRECISION * b
    found = float(np.median(product[told] / curved[told])) if told.any() else 0.0
    return found if abs(found) > 1e-2 * float(np.median(depth)) else 0.0


def judge(sums: Array) -> list[Finding | Unknown]:
    """Report a mistake with many votes for it and few against; with many of both, the result is unknown."""
    wins, losses = sums
    *plain, last = (wins >= ENOUGH) & (wins > 4 * losses)
    best = int(np.argmax(np.where(plain, wins[:-1], 0))) if any(plain) else len(wins) - 1
    if any(plain) or last:
        what, cure = MISTAKES[best]
        return [
            Finding(
                "depth",
                what,
                f"{wins[best]:g} of {wins[best] + losses[best]:g} planes are flat only after the correction",
                cure,
            )
        ]
    doubtful = (wins >= ENOUGH) & (4 * wins >= losses)
    if min(losses[0], losses[3:-1].max()) >= ENOUGH and not doubtful[:-1].any():
        return []
    return [Unknown(ENCODING.topic, "too few slanted planes, or depth is too coarse")]


ENCODING = Check("depth: linear, along the camera's axis", votes, judge, "too few planes", trusts=("normal", "depth"))
