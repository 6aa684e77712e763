"""Ray queries: Embree's trees, and alpha masks through which rays pass."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene
from numpy.typing import NDArray

from .boxes import bounds, passing
from .compiled import compiled
from .geometry import Triangles, lift, texture_coordinates
from .materials import Materials, is_solid
from .vec3 import Vec3
from .vectors import Float32

MISS = -1
FAR = np.float32(1e37)  # Embree's value for infinite distance


class Hits(NamedTuple):
    """The first hits of N rays: triangle number or `MISS`, barycentric coordinates, distance.

    Coordinates and distance are undefined for a miss.
    """

    triangle: NDArray[np.int32]
    b: Float32
    c: Float32
    distance: Float32

    @classmethod
    def none(cls, distance: Float32) -> Hits:
        """No hit yet, within `distance` (N,)."""
        return cls(np.full(len(distance), MISS, np.int32), np.empty_like(distance), np.empty_like(distance), distance)


class Left(NamedTuple):
    """For N rays, the triangle that each has left, or `MISS`, and how far behind it the ray continues."""

    triangle: NDArray[np.int32]
    way: Float32


class Tree:
    """Embree's tree of neighbouring triangles of a scene.

    Parameters
    ----------
    corners : (T, 3, 3) float32
        The first corner and two edges of each triangle.
    first : int
        The number of the first triangle in the scene.
    masked : bool
        Whether rays may pass through parts of the surfaces.
    """

    def __init__(self, corners: Float32, first: int, *, masked: bool) -> None:
        self.first, self.masked = first, masked
        self._embree = EmbreeScene()
        vertices = corners.copy()
        vertices[:, 1:] += corners[:, :1]
        self.box = bounds(vertices)
        TriangleMesh(self._embree, vertices)
        # Embree builds its tree at the first query, which must not happen in several threads at once.
        self.blocked(np.zeros((1, 3), np.float32), np.ones((1, 3), np.float32), np.ones(1, np.float32))

    def nearest(self, origin: Float32, direction: Float32, distance: Float32) -> Hits:
        """The first hits of rays (N, 3) within `distance` (N,), which is overwritten with the distance of the hits."""
        found = self._embree.run(origin, direction, dists=distance, output=1)
        return Hits(found["primID"], found["u"], found["v"], distance)

    def blocked(self, origin: Float32, direction: Float32, distance: Float32) -> NDArray[np.bool_]:
        """Whether any triangle is within `distance` (N,) along each ray (N, 3); `distance` is overwritten."""
        blocked: NDArray[np.bool_] = self._embree.run(origin, direction, dists=distance, query="OCCLUDED") == 0
        return blocked

    def near(self, origin: Float32, direction: Float32, distance: Float32) -> NDArray[np.int32]:
        """Indices of the rays (N, 3) that pass the tree's bounding box within `distance` (N,).

        Only these need a query.
        """
        return np.flatnonzero(passing([self.box], origin, direction, distance)).astype(np.int32)


class Trees:
    """All triangles of a scene at one time, for queries.

    Parameters
    ----------
    trees : sequence of Tree
        The trees, which together contain all of `triangles`.
    triangles : Triangles
    materials : Materials
        For finding where a masked surface is solid.
    """

    def __init__(self, trees: Sequence[Tree], triangles: Triangles, materials: Materials) -> None:
        self.trees, self.triangles, self.materials = tuple(trees), triangles, materials

    def clearance(self, point: Vec3) -> float:
        """The radius around `point` without any triangle; 0 if it is smaller than the scene."""
        box = bounds(np.array([tree.box for tree in self.trees]))
        gap = np.linalg.norm(np.clip(point, *box) - point)
        return max(float(gap - np.linalg.norm(box[1] - box[0])), 0.0)

    def intersect(self, origin: Float32, direction: Float32) -> Hits:
        """The first solid point on each ray from `origin` (N, 3) along the unit vectors `direction` (N, 3)."""
        distance = np.full(len(origin), FAR, np.float32)
        trees = list(self.trees)
        hits = trees.pop(0).nearest(origin, direction, distance) if not trees[0].masked else Hits.none(distance)
        for tree in trees:
            ray = tree.near(origin, direction, hits.distance)
            self._search(tree, ray, origin[ray], direction[ray], hits)
        return hits

    def occluded(self, origin: Float32, direction: Float32, distance: Float32) -> NDArray[np.bool_]:
        """Whether a solid point is within `distance` (N,) on each ray from `origin` (N, 3).

        `distance` is overwritten.
        """
        result = np.zeros(len(origin), np.bool_)
        for number, tree in enumerate(self.trees):
            if number == 0 and not tree.masked:
                result = tree.blocked(origin, direction, distance)
                continue
            distance[result] = -1.0  # no further queries for this ray
            ray = tree.near(origin, direction, distance)
            rays, ahead, reach = origin[ray], direction[ray], distance[ray]
            if tree.masked:
                hits = Hits.none(reach)
                self._search(tree, np.arange(len(ray), dtype=np.int32), rays, ahead, hits)
                result[ray] = hits.triangle != MISS
            else:
                result[ray] = tree.blocked(rays, ahead, reach)
        return result

    def _search(self, tree: Tree, ray: NDArray[np.int32], origin: Float32, direction: Float32, hits: Hits) -> None:
        """Write the tree's solid points to `hits` if they are nearer; at other points the ray continues.

        `ray` (K,) are the indices of the rays in `hits`.
        """
        travelled = np.zeros(len(ray), np.float32)
        latest = Left(np.full(len(ray), MISS, np.int32), np.empty(len(ray), np.float32))
        while len(ray):
            found = tree.nearest(origin, direction, hits.distance[ray] - travelled)
            passed = np.empty(len(ray), np.int32)
            count = _settle(
                self.triangles, self.materials, found, tree.first, tree.masked, ray, travelled, hits, passed, latest
            )
            passed = passed[:count]
            latest = Left(latest.triangle[passed], latest.way[passed])
            step = found.distance[passed] + latest.way
            ray, travelled = ray[passed], travelled[passed] + step
            direction = direction[passed]
            origin = origin[passed] + step[:, None] * direction


@compiled
def _settle(
    triangles: Triangles,
    materials: Materials,
    found: Hits,
    first: int,
    masked: bool,
    ray: NDArray[np.int32],
    travelled: Float32,
    hits: Hits,
    passed: NDArray[np.int32],
    latest: Left,
) -> int:
    """Write solid points to `hits`, and rays that hit a point that is not solid to `passed`; count the latter.

    `latest` is the triangle that each ray left last, and is updated.
    """
    count = 0
    for index in range(len(ray)):
        if found.triangle[index] == MISS:
            continue
        triangle = first + found.triangle[index]
        b, c = found.b[index], found.c[index]
        u, v = texture_coordinates(triangles, triangle, b, c)
        if not masked or is_solid(materials, triangles.material[triangle], u, v):
            target = ray[index]
            hits.triangle[target] = triangle
            hits.b[target], hits.c[target] = b, c
            hits.distance[target] = travelled[index] + found.distance[index]
        else:
            # Because of rounding, a ray that runs along a triangle may hit it again.
            again = triangle == latest.triangle[index]
            latest.way[index] = 2.0 * latest.way[index] if again else lift(triangles.corners, triangle)
            latest.triangle[index] = triangle
            passed[count] = index
            count += 1
    return count
