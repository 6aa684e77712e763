"""What several tests of the tracer estimate, and what it should be."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from tracer import Camera, CameraPath, Scene, Shot, render_frame

# Looks at one point of the floor, the origin, through a very long lens, from below all lamps.
AT_ORIGIN = Camera((0.15, 0.5, 0.2), (0.0, 0.0, 0.0), fov_y=0.01)


def under_rectangle(width: float, depth: float, height: float) -> float:
    """Form factor from a point to a rectangle straight above its normal, centred (Howell, C-11 four times)."""
    a, b = width / 2 / height, depth / 2 / height
    first = a / math.hypot(1, a) * math.atan(b / math.hypot(1, a))
    return 4 * (first + b / math.hypot(1, b) * math.atan(a / math.hypot(1, b))) / (2 * math.pi)


def mean_and_error(
    scene: Scene, camera: Camera = AT_ORIGIN, *, field: str = "color", bounces: int = 0, side: int = 200
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Mean over all pixels of a picture that shows one point, and its standard error."""
    frame = render_frame(Shot(scene, (side, side), camera_path=CameraPath.static(camera)), 0, bounces=bounces)
    values = getattr(frame, field).reshape(-1, 3).astype(np.float64)
    return values.mean(0), values.std(0) / math.sqrt(len(values))
