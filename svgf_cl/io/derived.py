"""Computes depth and motion that files lack from their other fields and from cameras."""

from __future__ import annotations

import numpy as np

from svgf_cl.camera import Camera, motion_from_cameras
from svgf_cl.io.readers.reader import Values


def derived(values: Values, camera: Camera | None, previous: Camera | None, *, still: bool) -> Values:
    """Return depth and motion, as far as they are missing and can be computed.

    Parameters
    ----------
    values : Values
        The fields that the file has.
    camera, previous : Camera, optional
        The cameras of the frame and of the previous one.
    still : bool
        Whether nothing moves.
    """
    found: Values = {}
    position, depth = values.get("position"), values.get("depth")
    position = None if position is None else np.where(np.isfinite(position), position, np.nan)
    missed = ~np.any(values["normal"], axis=-1) if "normal" in values else np.False_
    if depth is None and camera is not None:
        if position is not None:
            depth = camera.depth_at(position)
        elif "distance" in values:
            depth = camera.depth_of(values["distance"])
    if depth is not None:
        depth = np.where(missed | ~(depth > 0), np.inf, depth) if "depth" not in values else depth
        found["depth"] = np.asarray(depth, np.float32)
    if "motion" in values or depth is None:
        return found
    if camera is not None:
        seen = np.where(missed, np.inf, depth)
        found["motion"] = motion_from_cameras(camera, previous or camera, depth=seen, position=position)
    elif still:
        found["motion"] = np.zeros((*depth.shape, 2), np.float32)
    return found
