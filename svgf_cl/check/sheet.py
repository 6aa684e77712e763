"""Draws the fields of a frame in one picture, to look for mistakes."""

from __future__ import annotations

import numpy as np

from svgf_cl.check.motion import bilinear, features
from svgf_cl.check.view import Array, View
from svgf_cl.frame import Frame
from svgf_cl.io.display import Bytes, automatic_exposure, to_bytes
from svgf_cl.io.panels import contact_sheet


def sheet(before: Frame, now: Frame) -> Bytes:
    """Draw the fields of a frame, and its difference from the previous frame moved by the motion vectors.

    Returns
    -------
    (H, W, 3) uint8
        Normals are drawn as (n + 1) / 2. The nearest depth is white. Motion is drawn by its direction (hue: red to the
        right, then yellow, green down, blue) and its length (brightness, up to the fastest). Ids have arbitrary
        colours. The difference is black where motion leads to the same surface.
    """
    view = View.of(now)
    nearest = view.nearness.max(initial=1e-30)
    panels = {
        "color": to_bytes(view.color, automatic_exposure(view.color)),
        "normal": as_is(0.5 * view.normal + 0.5),
        "depth": as_is(grey(view.nearness / nearest)),
        "motion": as_is(wheel(view.motion)),
        "difference after motion": as_is(grey(left_over(View.of(before), view))),
    }
    if view.albedo is not None:
        panels["albedo"] = to_bytes(view.albedo)
    if view.id is not None:
        colors = np.random.default_rng(0).integers(64, 256, (256, 3), np.uint8)
        panels["id"] = np.where(view.id[..., None] > 0, colors[view.id % 256], np.uint8(0))
    return contact_sheet(panels)


def left_over(before: View, now: View) -> Array:
    """Return the difference of features from the previous frame at the place where motion leads, (h, w), from 0 on."""
    y, x = np.indices(now.shape)
    there, *_ = bilinear(features(before), (x + now.motion[..., 0]).ravel(), (y + now.motion[..., 1]).ravel())
    return np.where(now.hit, np.abs(features(now) - there.reshape(*now.shape, -1)).sum(axis=-1), 0)


def wheel(motion: Array) -> Array:
    """Return direction as hue and length as brightness: (h, w, 2) to (h, w, 3)."""
    length = np.linalg.norm(motion, axis=-1)
    angle = np.arctan2(motion[..., 1], motion[..., 0])
    thirds = angle[..., None] - 2 * np.pi / 3 * np.arange(3)
    brightness = np.minimum(length / max(float(np.percentile(length, 99)), 1e-6), 1)
    colors: Array = brightness[..., None] * np.clip(0.5 + np.cos(thirds), 0, 1)
    return colors


def grey(values: Array) -> Array:
    """Return the value in all three channels, (h, w, 3)."""
    return np.broadcast_to(values[..., None], (*values.shape, 3))


def as_is(values: Array) -> Bytes:
    """Return values of 0 to 1 in 8 bits, without exposure or curve."""
    return np.rint(255 * np.clip(values, 0, 1)).astype(np.uint8)
