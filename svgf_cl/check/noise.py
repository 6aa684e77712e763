"""Whether the depth of a frame is noisy: under depth of field, motion blur and fog, or where rays are jittered."""

from __future__ import annotations

import numpy as np

from svgf_cl.frame import Frame

LEAST_LENGTH = 1e-6  # of a normal
# Along a row of pixels on a plane, one over depth rises evenly. By this share of it a pixel is off if depth is noisy.
UNEVEN = 5e-4
PLANE = 0.999  # cosine between normals of one plane
HOLES = 0.02  # share of pixels that hit nothing between two that did: rays that were scattered before they hit


def has_noisy_depth(frame: Frame) -> bool:
    """Whether the depth of a frame is noisy."""
    hit = np.any(frame.normal, axis=-1) & (frame.depth > 0.0) & np.isfinite(frame.depth)
    left, middle, right = (np.s_[:, place : frame.shape[1] - 2 + place] for place in range(3))
    if (hit[left] & ~hit[middle] & hit[right]).sum() > HOLES * hit.size:
        return True
    with np.errstate(invalid="ignore"):  # an infinite normal is of no plane
        unit = frame.normal / np.maximum(np.linalg.norm(frame.normal, axis=-1, keepdims=True), LEAST_LENGTH)
    is_flat = [np.sum(unit[side] * unit[middle], axis=-1) > PLANE for side in (left, right)]
    plane = hit[left] & hit[middle] & hit[right] & is_flat[0] & is_flat[1]
    nearness = 1.0 / np.where(hit, frame.depth, 1.0).astype(np.float64)
    bend = np.abs(nearness[left] - 2.0 * nearness[middle] + nearness[right])[plane] / nearness[middle][plane]
    return bend.size > 0 and float(np.median(bend)) > UNEVEN
