"""The triangles of a scene, and what is found where a ray hits them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene
from numpy.typing import NDArray

from .materials import Material
from .motion import Motion
from .vectors import Float32, Float64, dot, normalise


@dataclass(frozen=True, eq=False)
class Instance:
    """One object of the scene: triangles and their material.

    Parameters
    ----------
    corners : (T, 3, 3) float
        Triangle, corner, (x, y, z) in world space; counter-clockwise seen from the front.
    material : Material
    normals : (T, 3, 3) float, optional
        Unit shading normals at the corners; the triangles are flat where absent.
    uv : (T, 3, 2) float, optional
        Texture coordinates, v up; 0 where absent.
    motion : Motion, optional
        Carries corners and normals, which are then in the object's own space, into the world.
    """

    corners: NDArray[np.floating]
    material: Material
    normals: NDArray[np.floating] | None = None
    uv: NDArray[np.floating] | None = None
    motion: Motion | None = None


@dataclass(frozen=True, eq=False)
class Hits:
    """The rays of a batch that hit something.

    Parameters
    ----------
    ray : (K,) int
        Their numbers in the batch, ascending.
    triangle : (K,) int32
    u, v : (K,) float32
        Barycentric coordinates of the second and third corner.
    """

    ray: NDArray[np.intp]
    triangle: NDArray[np.int32]
    u: Float32
    v: Float32


@dataclass(frozen=True, eq=False)
class Surface:
    """Where a batch of K rays met the scene; both normals look to the side the ray came from.

    Parameters
    ----------
    origin : (3, K) float32
        Start for new rays: the point, lifted off the surface by more than its rounding error.
    normal, face_normal : (3, K) float32
        Unit shading and geometric normal.
    uv : (2, K) float32
    front : (K,) bool
        Whether the ray met the side from which the corners run counter-clockwise.
    material : (K,) int32
    """

    origin: Float32
    normal: Float32
    face_normal: Float32
    uv: Float32
    front: NDArray[np.bool_]
    material: NDArray[np.int32]


class Triangles:
    """Every triangle of the scene, with Embree's tree over them.

    Attributes
    ----------
    corner, edge1, edge2 : (3, T) float32
        First corner, and the edges from it to the other two.
    instance : (T,) uint32
        Instance id of each triangle, from 1.
    material : (T,) int32
        Index of its material.
    lift : float
        Distance by which new rays start off a surface, in scene units.
    """

    def __init__(self, instances: Sequence[Instance], materials: Sequence[int]) -> None:
        corners = np.concatenate([i.corners for i in instances]).astype(np.float32)
        counts = [len(i.corners) for i in instances]
        self.instance = np.repeat(np.arange(1, len(instances) + 1, dtype=np.uint32), counts)
        self.material = np.repeat(np.array(materials, np.int32), counts)
        self.corner, self.edge1, self.edge2 = _corner_and_edges(corners)
        self._face_normal = normalise(np.cross(self.edge1, self.edge2, axis=0))
        flat = np.repeat(self._face_normal.T[:, None], 3, axis=1)
        starts = np.cumsum(counts) - counts
        for item, start, count in zip(instances, starts, counts, strict=True):
            if item.normals is not None:
                flat[start : start + count] = item.normals
        self._normals = _corner_and_edges(flat)
        uv = [np.zeros((count, 3, 2)) if i.uv is None else i.uv for i, count in zip(instances, counts, strict=True)]
        self._uv = _corner_and_edges(np.concatenate(uv).astype(np.float32))
        # Positions carry an error of a few units in the last place of the largest coordinate, about 1e-7 of it.
        self.lift = np.float32(1e-5 * np.abs(corners).max())
        self._embree = EmbreeScene()
        TriangleMesh(self._embree, corners)
        # Embree builds its tree at the first query: not in several threads at once.
        self.occluded(np.zeros((3, 1), np.float32), np.ones((3, 1), np.float32))

    def intersect(self, origin: Float32, direction: Float32) -> Hits:
        """The first hit of each ray from `origin` (3, N) along `direction` (3, N), of any length."""
        found = self._embree.run(origin.T, direction.T, output=1)
        triangle = found["primID"]
        ray = np.flatnonzero(triangle >= 0)
        return Hits(ray, triangle.take(ray), found["u"].take(ray), found["v"].take(ray))

    def occluded(self, origin: Float32, direction: Float32, reach: float = np.inf) -> NDArray[np.bool_]:
        """Whether anything lies on each ray between `origin` and `origin + reach * direction`: (N,)."""
        blocked: NDArray[np.bool_] = self._embree.run(origin.T, direction.T, dists=reach, query="OCCLUDED") == 0
        return blocked

    def surface(self, hits: Hits, direction: Float32) -> Surface:
        """What the rays of `direction` (3, K), one for each hit, met."""
        u, v, t = hits.u, hits.v, hits.triangle
        face_normal = self._face_normal.take(t, axis=1)
        front = dot(face_normal, direction) < 0
        face_normal *= np.where(front, np.float32(1), np.float32(-1))
        normal = normalise(_interpolate(self._normals, t, u, v))
        normal *= np.copysign(np.float32(1), dot(normal, face_normal))
        origin = _interpolate((self.corner, self.edge1, self.edge2), t, u, v)
        origin += self.lift * face_normal
        uv = _interpolate(self._uv, t, u, v)
        return Surface(origin, normal, face_normal, uv, front, self.material.take(t))

    def positions(self, triangle: NDArray[np.integer], u: Float32, v: Float32) -> Float64:
        """World positions (3, K) in double precision."""
        result = self.corner.take(triangle, axis=1).astype(np.float64)
        result += self.edge1.take(triangle, axis=1) * u.astype(np.float64)
        result += self.edge2.take(triangle, axis=1) * v.astype(np.float64)
        return result

    def uv(self, triangle: NDArray[np.integer], u: Float32, v: Float32) -> Float32:
        """Texture coordinates (2, K) at barycentric coordinates of triangles (K,)."""
        return _interpolate(self._uv, triangle, u, v)


def _corner_and_edges(values: Float32) -> tuple[Float32, Float32, Float32]:
    """Split per-corner values (T, 3, C) into the first corner's and the differences to it, as planes (C, T)."""
    first = values[:, 0]
    planes = (first, values[:, 1] - first, values[:, 2] - first)
    a, b, c = (np.ascontiguousarray(plane.T) for plane in planes)
    return a, b, c


def _interpolate(
    table: tuple[Float32, Float32, Float32], triangle: NDArray[np.integer], u: Float32, v: Float32
) -> Float32:
    first, edge1, edge2 = (plane.take(triangle, axis=1) for plane in table)
    edge1 *= u
    edge2 *= v
    first += edge1
    first += edge2
    return first
