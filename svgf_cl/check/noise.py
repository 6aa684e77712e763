"""Detects frames with noisy depth (depth of field, motion blur, fog, jittered rays), and frames that lack motion."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from svgf_cl.check.view import length, over_channels
from svgf_cl.frame import Frame

Array = npt.NDArray[np.float32]

LEAST_LENGTH = 1e-6  # of a normal
# In a row of pixels on a plane, one over depth changes evenly. If depth is noisy, pixels deviate by this share of it.
UNEVEN = 5e-4
PLANE = 0.999  # least cosine between normals of one plane
APART = 0.05  # a pixel that has moved exceeds all values that were around it by this
MOVED = 0.1  # share of such pixels; if there are more, it is not only noise
HOLES = 0.02  # share of pixels that hit nothing between two that did, because their rays were scattered


def has_noisy_depth(frame: Frame) -> bool:
    """Whether the depth of a frame is noisy."""
    hit = over_channels(np.logical_or, frame.normal != 0) & (frame.depth > 0.0) & np.isfinite(frame.depth)
    left, middle, right = (np.s_[:, place : frame.shape[1] - 2 + place] for place in range(3))
    if (hit[left] & ~hit[middle] & hit[right]).sum() > HOLES * hit.size:
        return True
    with np.errstate(invalid="ignore"):  # an infinite normal belongs to no plane
        unit = frame.normal / np.maximum(length(frame.normal), LEAST_LENGTH)[..., None]
    is_flat = [np.einsum("...c,...c->...", unit[side], unit[middle]) > PLANE for side in (left, right)]
    plane = hit[left] & hit[middle] & hit[right] & is_flat[0] & is_flat[1]
    nearness = 1.0 / np.where(hit, frame.depth, 1.0).astype(np.float64)
    bend = np.abs(nearness[left] - 2.0 * nearness[middle] + nearness[right])[plane] / nearness[middle][plane]
    return bend.size > 0 and float(np.median(bend)) > UNEVEN


def lacks_motion(frame: Frame, previous: Frame) -> bool:
    """Whether motion is 0 in the whole frame, although surfaces have moved since the previous frame.

    This is so in Blender's frames with motion blur. Surfaces are recognised by their albedo, or else by their normals.
    """
    if np.any(frame.motion):
        return False
    before, now = ((f.normal if f.albedo is None else f.albedo) for f in (previous, frame))
    least, most = extremes(before)
    beyond = np.maximum(least - now, now - most).max(axis=-1)
    return bool((beyond > APART).mean() > MOVED)


def extremes(value: Array) -> tuple[Array, Array]:
    """Return the least and the greatest value (H, W, C) of each pixel and its eight neighbours; NaN does not count.

    A filtered value that is limited to this range leaves no ghost where motion is wrong.
    """
    padded = np.pad(value, ((1, 1), (1, 1), (0, 0)), mode="edge")
    found = []
    for choose in (np.fmin, np.fmax):
        rows = choose(choose(padded[:-2], padded[1:-1]), padded[2:])
        found.append(choose(choose(rows[:, :-2], rows[:, 1:-1]), rows[:, 2:]))
    return found[0], found[1]
