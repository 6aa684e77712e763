"""Matrices of cameras as renderers write them into the headers of OpenEXR files."""

from __future__ import annotations

import numpy as np

from svgf_cl import Camera
from svgf_cl.frame import Shape


def header(
    camera: Camera, shape: Shape, *, forward: int = 1, low: int = 0, down: bool = True, square: bool = False, w: int = 1
) -> tuple[np.ndarray, np.ndarray]:
    """The matrices worldToCamera and worldToNDC of a renderer with these habits, for rows, in single precision."""
    to_camera = np.diag((1.0, -1.0, forward, 1.0)) @ camera.world_to_view
    (fx, fy), (cx, cy), sides = camera.focal, camera.center, np.array(shape[::-1], float)
    spans = np.full(2, sides.min()) if square else sides
    from_middle = (np.array((cx, cy)) + 0.5 - sides / 2) / spans
    scale = np.array((fx, -fy)) / spans
    if not down:
        from_middle[1], scale[1] = -from_middle[1], -scale[1]
    if low == -1:
        from_middle, scale = 2 * from_middle, 2 * scale
    else:
        from_middle += 0.5
    projection = np.zeros((4, 4))
    projection[[0, 1], [0, 1]] = scale
    projection[2, 2], projection[3, 2] = 1.001 * forward, -0.1001
    if camera.orthographic:
        projection[3, :2], projection[3, 3] = from_middle, 1.0
    else:
        projection[2, :2], projection[2, 3] = from_middle * forward, w * forward
    return to_camera.T.astype(np.float32), (to_camera.T @ projection).astype(np.float32)


HABITS = {
    "OpenEXR's definition": {},
    "Arnold": {"low": -1, "down": False},
    "pbrt": {"down": False, "square": True},
    "Mantra": {"low": -1, "down": False, "w": -1},
    "OpenGL": {"forward": -1, "low": -1, "down": False},
}
