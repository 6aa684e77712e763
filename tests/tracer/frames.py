"""Path-traced frames for the tests of kernels and filter."""

from __future__ import annotations

import functools

from svgf_cl.frame import Frame, Shape
from svgf_cl_tracer import Shot, builtin_scene, render_sequence
from tests.frames import SHAPE, only


@functools.cache
def traced_sequence(
    fields: tuple[str, ...], count: int = 5, shape: Shape = (SHAPE[0] + 1, 2 * SHAPE[1])
) -> tuple[Frame, ...]:
    """Path-traced frames of the built-in scene under its moving camera."""
    shot = Shot(builtin_scene(), shape, count)
    return tuple(only(frame, fields) for frame in render_sequence(shot))
