from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from svgf_cl_tracer import vec3
from svgf_cl_tracer.compiled import compiled

A, B = (1.0, -2.0, 3.0), (0.5, 4.0, -1.5)
NORMALS = [(0.0, 0.0, 1.0), (0.0, 0.0, -1.0), (1.0, 0.0, 0.0), (0.36, 0.48, 0.8), (0.48, -0.6, -0.64)]


def test_arithmetic_is_numpys() -> None:
    np.testing.assert_allclose(vec3.dot(A, B), np.dot(A, B))
    np.testing.assert_allclose(vec3.cross(A, B), np.cross(A, B))
    np.testing.assert_allclose(vec3.add(A, B), np.add(A, B))
    np.testing.assert_allclose(vec3.subtract(A, B), np.subtract(A, B))
    np.testing.assert_allclose(vec3.multiply(A, B), np.multiply(A, B))
    np.testing.assert_allclose(vec3.scale(A, -3.0), np.multiply(A, -3.0))
    np.testing.assert_allclose(vec3.normalise(A), np.divide(A, np.linalg.norm(A)))


def test_a_vector_of_length_0_stays_as_it_is() -> None:
    assert vec3.normalise((0.0, 0.0, 0.0)) == (0.0, 0.0, 0.0)


def test_white_has_luminance_1() -> None:
    np.testing.assert_allclose(vec3.luminance((1.0, 1.0, 1.0)), 1.0)
    assert vec3.luminance((0.0, 1.0, 0.0)) > vec3.luminance((1.0, 0.0, 0.0)) > vec3.luminance((0.0, 0.0, 1.0))


@pytest.mark.parametrize("normal", NORMALS)
def test_the_frame_of_a_normal_is_orthonormal_and_right_handed(normal: vec3.Vec3) -> None:
    tangent, bitangent = vec3.tangents(normal)
    frame = np.array([tangent, bitangent, normal])
    np.testing.assert_allclose(frame @ frame.T, np.eye(3), atol=1e-12)
    np.testing.assert_allclose(np.linalg.det(frame), 1.0)


@pytest.mark.parametrize("normal", NORMALS)
def test_there_and_back_is_the_same_vector(normal: vec3.Vec3) -> None:
    np.testing.assert_allclose(vec3.to_world((0.0, 0.0, 1.0), normal), normal, atol=1e-12)
    np.testing.assert_allclose(vec3.to_local(vec3.to_world(A, normal), normal), A, atol=1e-12)


@compiled
def squared_length(rows: NDArray[np.float32], out: NDArray[np.float64]) -> None:
    out[0] = vec3.dot(vec3.row(rows, 1), vec3.row(rows, 1))


def test_arithmetic_on_rows_of_single_precision_is_in_double_precision() -> None:
    rows, out = np.array([A, (0.1, 0.2, 0.3)], np.float32), np.empty(1)
    squared_length(rows, out)
    assert out[0] == pytest.approx(np.square(rows[1].astype(np.float64)).sum(), rel=1e-14)
