"""Matrices of cameras: checks and inverts rigid ones, and interprets those in the header of an OpenEXR file."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from svgf_cl.errors import ArgumentError, shown

Array = npt.NDArray[np.float64]

RIGID = 1e-3  # greatest difference between the identity and the product of a rotation and its transpose
CENTRAL = 0.25  # greatest distance of a header's optical axis from the middle of the image, in NDC


class Projection(NamedTuple):
    """The parameters of `svgf_cl.camera.Camera`."""

    world_to_view: Array
    focal: tuple[float, float]
    center: tuple[float, float]
    orthographic: bool


def rigid(argument: str, value: npt.ArrayLike) -> Array:
    """Return `value` as a double-precision matrix; raise `ArgumentError` unless it only turns, moves and reflects."""
    matrix = np.array(value, np.float64)
    if matrix.shape != (4, 4):
        raise ArgumentError(argument, "shape (4, 4)", f"shape {matrix.shape}")
    if not _is_rigid(matrix):
        expected = "a rotation and a translation without scale, for columns (x, y, z, 1)"
        raise ArgumentError(argument, expected, shown(matrix.tolist()))
    matrix[3] = (0.0, 0.0, 0.0, 1.0)
    matrix.flags.writeable = False
    return matrix


def inverse(matrix: Array) -> Array:
    """Return the inverse of a matrix that turns and moves."""
    result = np.eye(4)
    result[:3, :3] = np.linalg.inv(matrix[:3, :3])
    result[:3, 3] = -result[:3, :3] @ matrix[:3, 3]
    return result


def projection_of(world_to_camera: npt.ArrayLike, world_to_ndc: npt.ArrayLike, shape: tuple[int, int]) -> Projection:
    """Interpret the matrices of a header; see `svgf_cl.camera.Camera.from_matrices`.

    Raises
    ------
    ArgumentError
        If they do not belong to one camera.
    """
    matrix, projection = _consistent(world_to_camera, world_to_ndc)
    w_of_z, sides = projection[2, 3], np.array((shape[1], shape[0]), np.float64)
    orthographic = bool(abs(w_of_z) < 0.5)
    looks_back = bool(w_of_z < -0.5 and np.linalg.det(matrix[:3, :3]) > 0.0)
    forward = -1.0 if looks_back else 1.0
    # The change of NDC along the camera's x and y at depth 1, and the NDC of its axis.
    slope = projection[[0, 1], [0, 1]] / (1.0 if orthographic else w_of_z * forward)
    axis = projection[3, :2] if orthographic else projection[2, :2] / w_of_z
    origin = _origin(axis)
    is_uniform = origin == 0.5 and math.isclose(*np.abs(slope), rel_tol=1e-4)
    per_unit = (sides.min() if is_uniform else sides) * (0.5 if origin == 0.0 else 1.0)
    focal = np.abs(slope) * per_unit
    # The camera's x points to the right and its y up, in whatever direction x and y of NDC point.
    center = (sides - 1.0) / 2.0 + (axis - origin) * per_unit * np.sign(slope) * (1.0, -1.0)
    to_view = np.diag((1.0, -1.0, forward, 1.0))
    return Projection(to_view @ matrix.T, (focal[0], focal[1]), (center[0], center[1]), orthographic)


def _origin(axis: Array) -> float:
    """Return the NDC of the middle of the image, if the optical axis is at `axis` (x, y)."""
    for origin in (0.0, 0.5):
        if np.all(np.abs(axis - origin) < CENTRAL):
            return origin
    expected = "an optical axis near (0, 0) or (0.5, 0.5)"
    raise ArgumentError("Camera.from_matrices(world_to_ndc)", expected, shown(tuple(axis.tolist())))


def _is_rigid(matrix: Array) -> bool:
    """Whether `matrix` (4, 4) only turns, moves and reflects columns."""
    rotation = matrix[:3, :3]
    is_affine = np.isfinite(matrix).all() and np.allclose(matrix[3], (0.0, 0.0, 0.0, 1.0), rtol=0.0, atol=1e-5)
    return bool(is_affine and np.allclose(rotation @ rotation.T, np.eye(3), rtol=0.0, atol=RIGID))


def _consistent(world_to_camera: npt.ArrayLike, world_to_ndc: npt.ArrayLike) -> tuple[Array, Array]:
    """Return world to camera, and camera to NDC, for rows (x, y, z, 1), from matrices that may be transposed."""
    camera, ndc = np.array(world_to_camera, np.float64), np.array(world_to_ndc, np.float64)
    for name, matrix in (("world_to_camera", camera), ("world_to_ndc", ndc)):
        if matrix.shape != (4, 4) or not np.isfinite(matrix).all():
            raise ArgumentError(f"Camera.from_matrices({name})", "4 x 4 finite numbers", shown(matrix.tolist()))
    readings = [(m, inverse(m.T).T @ n) for m, n in ((camera, ndc), (camera.T, ndc.T)) if _is_rigid(m.T)]
    if not readings:
        expected = "a rotation and a translation without scale"
        raise ArgumentError("Camera.from_matrices(world_to_camera)", expected, shown(camera.tolist()))
    # A camera at the origin without rotation has a symmetric matrix, so that both readings are rigid.
    matrix, projection = min(readings, key=lambda reading: _deviation(reading[1]))
    if not _deviation(projection) < RIGID:
        expected = "the projection of a camera in perspective or an orthographic one, that fits world_to_camera"
        raise ArgumentError("Camera.from_matrices(world_to_ndc)", expected, shown(ndc.tolist()))
    return matrix, projection


def _deviation(projection: Array) -> float:
    """Return how far a matrix from camera space to NDC, for rows, is from a projection's form.

    In a projection, x depends on x, y on y, and w on z or 1. The last row is not used, as single precision loses digits
    there, far from the origin.
    """
    scale = np.abs(projection[[0, 1], [0, 1]])
    if not scale.min() > 0.0:
        return math.inf
    skew = np.abs(projection[[0, 1], [1, 0]]) / scale.min()
    w_of_z = abs(projection[2, 3])
    return float(max(*skew, *np.abs(projection[:2, 3]), min(w_of_z, abs(w_of_z - 1.0))))
