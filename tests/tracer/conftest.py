from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

import svgf_cl_tracer.api  # noqa: F401  # now: what it has compiled lies in the user's own cache folder, not the tests'
from svgf_cl_tracer.geometry import Instance
from svgf_cl_tracer.materials import Material
from svgf_cl_tracer.motion import Motion

Quad = Callable[..., Instance]


@pytest.fixture(scope="session")
def quad() -> Quad:
    """Maker of rectangles; the front is the side towards right x up."""

    def make(
        corner: tuple[float, float, float],
        right: tuple[float, float, float],
        up: tuple[float, float, float],
        material: Material | None = None,
        motion: Motion | None = None,
    ) -> Instance:
        st = np.array([[[0, 0], [1, 0], [1, 1]], [[0, 0], [1, 1], [0, 1]]], float)
        corners = np.array(corner) + st[..., :1] * np.array(right) + st[..., 1:] * np.array(up)
        return Instance(corners, material or Material(), uv=st, motion=motion)

    return make


@pytest.fixture(scope="session")
def floor(quad: Quad) -> Callable[[Material], Instance]:
    """Maker of a large square at y = 0, face up."""
    return lambda material: quad((-50, 0, 50), (100, 0, 0), (0, 0, -100), material)
