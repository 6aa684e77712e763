from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from svgf_cl_tracer.materials import Material
from svgf_cl_tracer.meshes import Mesh, instance
from svgf_cl_tracer.motion import Keyframes, Motion, Track
from tests.tracer.gltf_files import CORNERS, NORMAL

GREY = Material()


def square(*, smooth: bool = False) -> Mesh:
    return Mesh(CORNERS, np.array([[0, 1, 2], [0, 2, 3]]), np.array(4 * [NORMAL]) if smooth else None)


def scaled(*scale: float) -> Motion:
    return Motion([np.diag([*scale, 1.0])])


def test_a_mirrored_object_keeps_its_front() -> None:
    still = instance(square(), scaled(-1, 1, 1), GREY).corners
    assert (np.cross(still[:, 1] - still[:, 0], still[:, 2] - still[:, 0])[:, 2] > 0).all()


def test_what_its_keyframes_leave_where_it_is_does_not_move() -> None:
    assert instance(square(), Motion([Keyframes(scale=Track([0, 1], [[1, 1, 1], [1, 1, 1]]))]), GREY).motion is None
    assert instance(square(), Motion([Keyframes(scale=Track([0, 1], [[1, 1, 1], [1, 1, 2]]))]), GREY).motion is not None


def test_corners_keep_what_is_theirs_when_triangles_are_turned_over() -> None:
    uv, colours = CORNERS[:, :2] + 1, CORNERS + 0.5
    made = instance(replace(square(), uv=uv, colours=colours), scaled(-1, 1, 1), GREY)
    np.testing.assert_array_equal(made.uv, made.corners[..., :2] * (-1, 1) + 1)
    np.testing.assert_array_equal(made.colours, made.corners * (-1, 1, 1) + 0.5)


def test_a_mesh_without_normals_is_flat() -> None:
    assert instance(square(), scaled(1, 1, 1), GREY).normals is None


@pytest.mark.parametrize("scale", [(1, 1, 1), (1, 1, 0.5), (1, 1, 2), (1e-7, 1e-7, 1e-7)])
def test_normals_turn_with_what_they_stand_on(scale: tuple[float, float, float]) -> None:
    expected = np.array(NORMAL) / scale
    expected /= np.linalg.norm(expected)
    normals = instance(square(smooth=True), scaled(*scale), GREY).normals
    np.testing.assert_allclose(normals, np.broadcast_to(expected, (2, 3, 3)), atol=1e-6)


@pytest.mark.parametrize("scale", [(1, 1, 0), (1, 0, 1), (0, 0, 0)])
def test_a_flattened_object_is_no_error(scale: tuple[float, float, float]) -> None:
    flat = instance(square(smooth=True), scaled(*scale), GREY)
    assert np.isfinite(flat.corners).all()
    assert np.isfinite(flat.normals).all()
