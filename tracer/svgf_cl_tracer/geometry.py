"""The triangles of a scene at one time, and the surface where a ray hits them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .boxes import bounds, corners_of_box
from .compiled import compiled
from .errors import SceneError
from .materials import Material
from .motion import Motion
from .vec3 import Vec3, add, cross, dot, normalise, scale
from .vectors import Float32, Float64


@dataclass(frozen=True, eq=False)
class Instance:
    """One object of the scene: triangles and their material.

    Parameters
    ----------
    corners : (T, 3, 3) float
        Triangle, corner, (x, y, z) in world space; counter-clockwise seen from the front.
    material : Material
    normals : (T, 3, 3) float, optional
        Unit shading normals at the corners; without them the triangles are flat.
    uv : (T, 3, 2) float, optional
        Texture coordinates, v up; 0 if absent.
    motion : Motion, optional
        Carries corners and normals into the world; they are then in the object's own space. The front moves with them,
        even if a mirroring motion makes the corners clockwise.
    colours : (T, 3, 3) float, optional
        Linear colours at the corners, 0..1, that multiply the material's base colour.

    Raises
    ------
    SceneError
        If an array has another shape.
    """

    corners: NDArray[np.floating]
    material: Material
    normals: NDArray[np.floating] | None = None
    uv: NDArray[np.floating] | None = None
    motion: Motion | None = None
    colours: NDArray[np.floating] | None = None

    def __post_init__(self) -> None:
        count = len(self.corners)
        for name, size in (("corners", 3), ("normals", 3), ("uv", 2), ("colours", 3)):
            values, expected = getattr(self, name), (count, 3, size)
            if values is not None and values.shape != expected:
                raise SceneError(f"instance: expected {name} of shape {expected}, got {values.shape}")

    @property
    def masked(self) -> bool:
        """Whether rays may pass through parts of its surface."""
        return self.material.alpha_cutoff is not None and self.material.base_texture is not None

    def corners_at(self, time: float) -> NDArray[np.floating]:
        """The corners (T, 3, 3) in the world at `time` in seconds."""
        return self._placed(self.corners, time)

    def box_at(self, time: float) -> Float64:
        """A box (2, 3) around it, in the world at `time` in seconds."""
        return self._box if self.motion is None else bounds(self._placed(corners_of_box(self._box), time))

    def normals_at(self, time: float) -> NDArray[np.floating]:
        """The normals (T, 3, 3) at the corners in the world at `time` in seconds."""
        if self.normals is None:
            corners = self.corners_at(time)
            face = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
            return unit(np.repeat(face[:, None], 3, axis=1))
        if self.motion is None:
            return self.normals
        return unit(_product(self.normals, cofactors(self.motion.matrix(time)[:3, :3])))

    def mirrored_at(self, time: float) -> bool:
        """Whether its corners are clockwise as seen from the front, in the world at `time` in seconds."""
        return self.motion is not None and mirrors(self.motion.matrix(time))

    def at_rest(self, time: float) -> Instance:
        """The same object without motion, at its place at `time` in seconds."""
        order = slice(None, None, -1) if self.mirrored_at(time) else slice(None)
        normals = None if self.normals is None else self.normals_at(time)[:, order]
        uv, colours = (None if values is None else values[:, order] for values in (self.uv, self.colours))
        corners = self.corners_at(time)[:, order]
        return replace(self, corners=corners, normals=normals, uv=uv, colours=colours, motion=None)

    def relative_to(self, origin: Vec3) -> Instance:
        """The same object with positions relative to `origin`."""
        if self.motion is None:
            return replace(self, corners=self.corners - np.array(origin, np.float64))
        return replace(self, motion=self.motion.relative_to(origin))

    @cached_property
    def _box(self) -> Float64:
        return bounds(self.corners)

    def _placed(self, points: NDArray[np.floating], time: float) -> NDArray[np.floating]:
        """Points (..., 3) of its own space, in the world."""
        if self.motion is None:
            return points
        matrix = self.motion.matrix(time)
        return _product(points, matrix[:3, :3]) + matrix[:3, 3]


class Triangles(NamedTuple):
    """Triangles as arrays. In arrays with three rows, the last two rows are differences from the first corner.

    Shapes: `corners` and `normals` (T, 3, 3), `uv` (T, 3, 2), `instance` (T,), with ids from 1, `material` (T,).
    `mirrored` (T,) says whether the corners are clockwise as seen from the front. `colours` is (T, 3, 3), or (0, 3, 3)
    if no instance has any.
    """

    corners: Float32
    normals: Float32
    uv: Float32
    instance: NDArray[np.uint32]
    material: NDArray[np.int32]
    mirrored: NDArray[np.bool_]
    colours: Float32

    @classmethod
    def of(cls, instances: Sequence[Instance], ids: Sequence[int], materials: Sequence[int], time: float) -> Triangles:
        """The triangles of instances with these ids and material numbers, at `time` in seconds."""
        counts = [len(instance.corners) for instance in instances]
        uv = [np.zeros((len(i.corners), 3, 2)) if i.uv is None else i.uv for i in instances]
        return cls(
            corners_of(instances, time),
            normals_of(instances, time),
            _differences(_joined(uv, (3, 2))),
            np.repeat(np.array(ids, np.uint32), counts),
            np.repeat(np.array(materials, np.int32), counts),
            mirrored_of(instances, time),
            _differences(_joined(_colours(instances), (3, 3))),
        )

    def moved(self, instances: Sequence[Instance], time: float) -> Triangles:
        """The same triangles, with the last ones (those of `instances`) at `time` in seconds."""
        first = len(self.corners) - sum(len(instance.corners) for instance in instances)
        return self._replace(
            corners=np.concatenate([self.corners[:first], corners_of(instances, time)]),
            normals=np.concatenate([self.normals[:first], normals_of(instances, time)]),
            mirrored=np.concatenate([self.mirrored[:first], mirrored_of(instances, time)]),
        )


def _colours(instances: Sequence[Instance]) -> list[NDArray[np.floating]]:
    """Colours (T, 3, 3) at the corners of each instance; empty if no instance has any."""
    if all(instance.colours is None for instance in instances):
        return []
    return [np.ones((len(i.corners), 3, 3)) if i.colours is None else i.colours for i in instances]


def corners_of(instances: Sequence[Instance], time: float) -> Float32:
    """The first corner and two edges (T, 3, 3) of every triangle of `instances` at `time` in seconds."""
    return _differences(_joined([instance.corners_at(time) for instance in instances], (3, 3)))


def normals_of(instances: Sequence[Instance], time: float) -> Float32:
    """The first corner's normal and two differences from it (T, 3, 3) for every triangle, likewise."""
    return _differences(_joined([instance.normals_at(time) for instance in instances], (3, 3)))


def mirrored_of(instances: Sequence[Instance], time: float) -> NDArray[np.bool_]:
    """For every triangle of `instances`, whether its corners are clockwise from the front at `time` in seconds."""
    mirrored = np.array([instance.mirrored_at(time) for instance in instances], np.bool_)
    return np.repeat(mirrored, [len(instance.corners) for instance in instances])


def mirrors(matrix: Float64) -> bool:
    """Whether a transform (4, 4) mirrors; a transform that flattens does not."""
    a, b, c = matrix[:3, :3].T
    # Because of rounding, the determinant of a flattening transform may be slightly different from 0.
    return bool(a @ np.cross(b, c) < -1e-14 * np.linalg.norm((a, b, c), axis=1).prod())


def cofactors(matrix: NDArray[np.floating]) -> Float64:
    """The matrix that transforms normals, up to length and sign, if `matrix` (3, 3) transforms points.

    It exists even if `matrix` flattens and so has no inverse. A mirroring matrix turns normals to the other side, so
    normals do not tell which side of a surface was hit.
    """
    # without scaling, the products of a small scale would count as zero
    a, b, c = matrix / (np.abs(matrix).max() or 1.0)
    return np.array([np.cross(b, c), np.cross(c, a), np.cross(a, b)])


class Surface(NamedTuple):
    """A point where a ray hit the scene; both normals point to the side from which the ray came.

    `point` is on the triangle. `lift` is the distance from the triangle at which a ray has certainly left it. `u` and
    `v` are texture coordinates. `front` says whether the ray hit the front.
    """

    point: Vec3
    face_normal: Vec3
    normal: Vec3
    lift: float
    u: float
    v: float
    material: int
    front: bool


@compiled
def surface_at(triangles: Triangles, triangle: int, b: float, c: float, direction: Vec3) -> Surface:
    """The surface that a ray along `direction` hit; `b`, `c` are barycentric coordinates of corners 2 and 3."""
    corners = triangles.corners
    edge1, edge2 = _row(corners, triangle, 1), _row(corners, triangle, 2)
    face_normal = normalise(cross(edge1, edge2))
    towards = dot(face_normal, direction) < 0.0
    if not towards:
        face_normal = scale(face_normal, -1.0)
    normal = normalise(interpolated(triangles.normals, triangle, b, c))
    if dot(normal, face_normal) < 0.0:
        normal = scale(normal, -1.0)
    # A shading normal that points away from the ray, or that is NaN, is useless for light that is reflected back.
    if not dot(normal, direction) < 0.0:
        normal = face_normal
    u, v = texture_coordinates(triangles, triangle, b, c)
    point = interpolated(corners, triangle, b, c)
    front = towards != triangles.mirrored[triangle]
    return Surface(point, face_normal, normal, lift(corners, triangle), u, v, triangles.material[triangle], front)


@compiled
def lift(corners: Float32, triangle: int) -> float:
    """The distance from a point on a triangle at which a ray has certainly left it.

    Rounding moves such a point off the triangle's plane, and Embree finds the triangle with an error, too. Both errors
    are at most 2e-7 of the largest coordinate. The code uses the sum of all coordinates instead of the largest, which
    takes longer to find.
    """
    corner, edge1, edge2 = _row(corners, triangle, 0), _row(corners, triangle, 1), _row(corners, triangle, 2)
    return 5e-7 * (_sum(corner) + _sum(edge1) + _sum(edge2))


@compiled
def _sum(vector: Vec3) -> float:
    return abs(vector[0]) + abs(vector[1]) + abs(vector[2])


@compiled
def interpolated(values: Float32, triangle: int, b: float, c: float) -> Vec3:
    """Values (T, 3, 3), as a corner and two differences, at barycentric coordinates, in double precision."""
    return add(_row(values, triangle, 0), add(scale(_row(values, triangle, 1), b), scale(_row(values, triangle, 2), c)))


@compiled
def texture_coordinates(triangles: Triangles, triangle: int, b: float, c: float) -> tuple[float, float]:
    """Texture coordinates (u, v) at barycentric coordinates in a triangle."""
    uv = triangles.uv
    u = np.float64(uv[triangle, 0, 0]) + b * uv[triangle, 1, 0] + c * uv[triangle, 2, 0]
    v = np.float64(uv[triangle, 0, 1]) + b * uv[triangle, 1, 1] + c * uv[triangle, 2, 1]
    return u, v


@compiled
def _row(values: Float32, triangle: int, corner: int) -> Vec3:
    vector = values[triangle, corner]
    return np.float64(vector[0]), np.float64(vector[1]), np.float64(vector[2])


def _differences(values: NDArray[np.floating]) -> Float32:
    """Values per corner (T, 3, C), with the second and third corner relative to the first one."""
    result = values.astype(np.float32)
    result[:, 1:] -= result[:, :1]
    return np.ascontiguousarray(result)


def _joined(parts: Sequence[NDArray[np.floating]], shape: tuple[int, int]) -> NDArray[np.floating]:
    return np.concatenate([*parts, np.zeros((0, *shape), np.float32)])


def _product(vectors: NDArray[np.floating], matrix: Float64) -> Float64:
    """`matrix` times each of `vectors` (..., 3), without BLAS, whose rounding may depend on the number of threads."""
    return vectors[..., :1] * matrix[:, 0] + vectors[..., 1:2] * matrix[:, 1] + vectors[..., 2:] * matrix[:, 2]


def unit(vectors: NDArray[np.floating]) -> NDArray[np.floating]:
    """`vectors` (..., 3) with length 1; vectors of length 0 are unchanged."""
    length = np.sqrt(np.square(vectors).sum(-1, keepdims=True))
    return vectors / np.where(length > 0.0, length, 1.0)
