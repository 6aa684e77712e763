"""A picture of the fields of a frame, for what one would rather see than be told."""

from __future__ import annotations

import numpy as np

from svgf_cl.check.motion import bilinear, features
from svgf_cl.check.view import Array, View
from svgf_cl.frame import Frame
from svgf_cl.io.display import Bytes, automatic_exposure, to_bytes
from svgf_cl.io.panels import contact_sheet


def sheet(before: Frame, now: Frame) -> Bytes:
    """Lay out the fields of a frame, and where it differs from the frame before once that is moved along.

    Returns
    -------
    (H, W, 3) uint8
        Normals as (n + 1) / 2; the nearest depth white; motion by its direction (hue: red where it leads to the right,
        then yellow, green down, blue) and length (brightness, up to that of the fastest); ids in arbitrary colours.
        The difference is black where motion leads to the same surface.
    """
    view = View.of(now)
    nearest = view.nearness.max(initial=1e-30)
    panels = {
        "color": to_bytes(view.color, automatic_exposure(view.color)),
        "normal": as_is(0.5 * view.normal + 0.5),
        "depth": as_is(grey(view.nearness / nearest)),
        "motion": as_is(wheel(view.motion)),
        "difference once moved": as_is(grey(left_over(View.of(before), view))),
    }
    if view.albedo is not None:
        panels["albedo"] = to_bytes(view.albedo)
    if view.id is not None:
        colors = np.random.default_rng(0).integers(64, 256, (256, 3), np.uint8)
        panels["id"] = np.where(view.id[..., None] > 0, colors[view.id % 256], np.uint8(0))
    return contact_sheet(panels)


def left_over(before: View, now: View) -> Array:
    """How much (h, w) what stays on surfaces differs from the frame before where motion leads, 0 to 1."""
    y, x = np.indices(now.shape)
    there, _ = bilinear(features(before), (x + now.motion[..., 0]).ravel(), (y + now.motion[..., 1]).ravel())
    return np.where(now.hit, np.abs(features(now) - there.reshape(*now.shape, -1)).sum(axis=-1), 0)


def wheel(motion: Array) -> Array:
    """Direction as hue, length as brightness: (h, w, 2) to (h, w, 3)."""
    length = np.linalg.norm(motion, axis=-1)
    angle = np.arctan2(motion[..., 1], motion[..., 0])
    thirds = angle[..., None] - 2 * np.pi / 3 * np.arange(3)
    brightness = np.minimum(length / max(float(np.percentile(length, 99)), 1e-6), 1)
    colors: Array = brightness[..., None] * np.clip(0.5 + np.cos(thirds), 0, 1)
    return colors


def grey(values: Array) -> Array:
    """One value for all three channels, (h, w, 3)."""
    return np.broadcast_to(values[..., None], (*values.shape, 3))


def as_is(values: Array) -> Bytes:
    """Values of 0 to 1 in 8 bits, without exposure or curve."""
    return np.rint(255 * np.clip(values, 0, 1)).astype(np.uint8)
