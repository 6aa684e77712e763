"""What several tests of the tracer estimate, and what it should be."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from svgf_cl.frame import Frame
from svgf_cl_tracer import Camera, CameraPath, Scene, Shot, render_frame

# Looks at one point of the floor, the origin, through a very long lens, from below all lamps.
AT_ORIGIN = Camera((0.15, 0.5, 0.2), (0.0, 0.0, 0.0), fov_y=0.01)


def under_rectangle(width: float, depth: float, height: float) -> float:
    """Form factor from a point to a rectangle straight above its normal, centred (Howell, C-11 four times)."""
    a, b = width / 2 / height, depth / 2 / height
    first = a / math.hypot(1, a) * math.atan(b / math.hypot(1, a))
    return 4 * (first + b / math.hypot(1, b) * math.atan(a / math.hypot(1, b))) / (2 * math.pi)


def still(scene: Scene, camera: Camera, shape: tuple[int, int] = (200, 200), **options: int | bool) -> Frame:
    """A frame of a scene seen by a camera that stands still."""
    return render_frame(Shot(scene, shape, camera_path=CameraPath.static(camera)), 0, **options)


def assert_mean(values: NDArray[np.float32], expected: ArrayLike, *, precision: float = 0.02) -> None:
    """That pixels (..., 3), independent estimates of `expected` (3,), have it as their mean.

    It must lie within four standard errors, which `precision` bounds relative to it.
    """
    values = values.reshape(-1, 3).astype(np.float64)
    expected = np.broadcast_to(expected, 3)
    error = values.std(0) / math.sqrt(len(values))
    assert (error <= precision * expected).all(), f"the estimate is only known to {error}"
    difference = values.mean(0) - expected
    assert (np.abs(difference) <= 4.0 * error + 1e-5 * expected).all(), (
        f"{difference} off {expected}, give or take {error}"
    )
