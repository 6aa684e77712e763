from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pytest
import trimesh
from numpy.typing import NDArray

from svgf_cl_tracer.geometry import Instance, lift
from svgf_cl_tracer.materials import Material, Materials, is_solid
from svgf_cl_tracer.motion import Motion
from svgf_cl_tracer.scene import Scene
from svgf_cl_tracer.trees import FAR, MISS, Hits, Tree, Trees

DOWN = (0.0, -1.0, 0.0)
# Opaque and transparent in turns, both across and up.
CHECKS = np.full((8, 8, 4), 255, np.uint8)
CHECKS[..., 3] = 255 * (np.indices((8, 8)).sum(0) % 2)
NOTHING = np.zeros((1, 1, 4), np.uint8)
CHEQUERED = Material(base_texture=CHECKS, alpha_cutoff=0.5)
INVISIBLE = Material(base_texture=NOTHING, alpha_cutoff=0.5)
STILL = Motion.sliding([0.0], [(0, 0, 0)])

Rows = NDArray[np.float32]


def trees(instances: Sequence[Instance], time: float = 0.0) -> Trees:
    return Scene(instances, sky=(1, 1, 1)).around((0.0, 0.0, 0.0)).at(time).trees


def rows(*vectors: tuple[float, float, float]) -> Rows:
    return np.array(vectors, np.float32)


def ids(found: Trees, hits: Hits) -> NDArray[np.int64]:
    """The instance of each hit, 0 of a miss."""
    return np.where(hits.triangle == MISS, 0, found.triangles.instance[hits.triangle]).astype(np.int64)


def reach(count: int, distance: float = float(FAR)) -> Rows:
    return np.full(count, distance, np.float32)


def soup(seed: int, material: Material, motion: Motion | None = None) -> Instance:
    """Twenty triangles anywhere in a cube, with texture coordinates."""
    random = np.random.default_rng(seed)
    corners = random.uniform(-1, 1, (20, 1, 3)) + random.uniform(-0.7, 0.7, (20, 3, 3))
    return Instance(corners, material, uv=random.uniform(0, 2, (20, 3, 2)), motion=motion)


def brute_force(instances: Sequence[Instance], time: float, origin: Rows, direction: Rows) -> tuple[NDArray, NDArray]:
    """Id and distance of the first solid point, by trying every triangle (Moller and Trumbore, 1997)."""
    nearest, found = np.full(len(origin), np.inf), np.zeros(len(origin), np.int64)
    materials = Materials.of([instance.material for instance in instances])
    for number, instance in enumerate(instances):
        for corners, uv in zip(instance.corners_at(time), instance.uv, strict=True):
            edges, offset = corners[1:] - corners[0], origin - corners[0]
            across = np.cross(direction, edges[1])
            with np.errstate(divide="ignore", invalid="ignore"):
                inverse = 1.0 / (across @ edges[0])
                b = (offset * across).sum(1) * inverse
                c = (direction * np.cross(offset, edges[0])).sum(1) * inverse
                distance = np.cross(offset, edges[0]) @ edges[1] * inverse
            hit = (b >= 0) & (c >= 0) & (b + c <= 1) & (distance > 0) & (distance < nearest)
            for ray in np.flatnonzero(hit):
                u, v = uv[0] + b[ray] * (uv[1] - uv[0]) + c[ray] * (uv[2] - uv[0])
                if not instance.masked or is_solid(materials, number, u, v):
                    nearest[ray], found[ray] = distance[ray], number + 1
    return found, nearest


def test_rays_find_the_nearest_triangle(floor: Callable[[Material], Instance]) -> None:
    roof = Instance(floor(Material()).corners + np.array((0, 2, 0)), Material())
    found = trees([floor(Material()), roof])
    hits = found.intersect(rows((1, 1, 2), (900, 1, 2), (1, 3, 2)), rows(DOWN, DOWN, DOWN))
    np.testing.assert_array_equal(ids(found, hits), (1, 0, 2))
    np.testing.assert_allclose(hits.distance[[0, 2]], 1)


def test_occlusion_ends_at_its_reach(floor: Callable[[Material], Instance]) -> None:
    found = trees([floor(Material())])
    for direction, distance, blocked in ((DOWN, 0.9, False), (DOWN, 1.1, True), ((0, 1, 0), 1e9, False)):
        assert found.occluded(rows((0.3, 1, 0.2)), rows(direction), reach(1, distance)) == [blocked]


MIXTURES = {
    "solid": [soup(1, Material())],
    "masked": [soup(1, CHEQUERED)],
    "masked and solid": [soup(1, CHEQUERED), soup(2, Material()), soup(3, CHEQUERED)],
    "masked, solid and moving": [
        soup(1, CHEQUERED),
        soup(2, Material(), Motion.sliding([0.0, 1.0], [(0, 0, 0), (1, 0, 0)])),
        soup(3, Material()),
        soup(4, CHEQUERED, Motion.turning((0, 0, 0), (1, 2, 3), [0.0, 1.0], [0.0, 90.0])),
        soup(5, INVISIBLE),
    ],
    "moving": [soup(1, Material(), STILL)],
    "moving and masked": [soup(1, CHEQUERED, STILL)],
}


@pytest.mark.parametrize("mixture", MIXTURES)
def test_any_mixture_of_trees_is_one_scene(mixture: str) -> None:
    instances, time = MIXTURES[mixture], 0.7
    random = np.random.default_rng(9)
    origin = random.uniform(-2, 2, (1500, 3)).astype(np.float32)
    direction = random.normal(size=(1500, 3))
    direction = (direction / np.linalg.norm(direction, axis=1, keepdims=True)).astype(np.float32)
    expected, distance = brute_force(instances, time, origin, direction)
    found = trees(instances, time)
    hits = found.intersect(origin, direction)
    # A ray in a thousand may see an edge of a triangle or of its mask from the other side.
    agree = ids(found, hits) == expected
    assert agree.mean() > 0.997
    met = agree & (expected > 0)
    assert met.any()
    np.testing.assert_allclose(hits.distance[met], distance[met], rtol=1e-4, atol=1e-4)
    np.testing.assert_array_equal(found.occluded(origin, direction, reach(1500)), hits.triangle != MISS)
    shorter = np.where(met, distance, 9.0) * random.uniform(0.5, 1.5, 1500)
    near = met & (np.abs(shorter - distance) > 1e-3)
    blocked = found.occluded(origin, direction, shorter.astype(np.float32))
    np.testing.assert_array_equal(blocked[near], (shorter > distance)[near])


def test_rays_pass_through_any_number_of_transparent_layers(floor: Callable[[Material], Instance]) -> None:
    layers = [Instance(floor(INVISIBLE).corners + np.array((0, y, 0)), INVISIBLE) for y in np.arange(1, 40) / 20]
    ground = floor(Material())
    origin, direction = rows((0.3, 5, 0.2), (1, 0.5, 2)), rows(DOWN, DOWN)
    alone = trees(layers)
    np.testing.assert_array_equal(alone.intersect(origin, direction).triangle, MISS)
    assert not alone.occluded(origin, direction, reach(2)).any()
    both = trees([*layers, ground])
    hits = both.intersect(origin, direction)
    np.testing.assert_array_equal(ids(both, hits), len(layers) + 1)
    np.testing.assert_allclose(hits.distance, (5, 0.5), rtol=1e-6)
    assert both.occluded(origin, direction, reach(2)).all()
    assert not both.occluded(origin, direction, reach(2, 0.4)).any()


def test_a_point_that_is_left_is_not_met_again_by_a_masked_ray(floor: Callable[[Material], Instance]) -> None:
    """A grazing ray stays near each layer for long."""
    layers = [Instance(floor(INVISIBLE).corners + np.array((0, y, 0)), INVISIBLE) for y in (0.1, 0.2, 0.3)]
    graze = np.array((1.0, -1e-3, 0.0)) / np.hypot(1.0, 1e-3)
    found = trees([*layers, floor(Material())])
    hits = found.intersect(rows((-49, 0.09, 0), (-49, 0.05, 0)), rows(graze, graze))
    np.testing.assert_array_equal(ids(found, hits), (4, 4))


@pytest.mark.parametrize("place", [0.0, 10.0, 1000.0])
@pytest.mark.parametrize("motion", [None, STILL])
def test_rays_that_leave_a_surface_do_not_find_it_again(place: float, motion: Motion | None) -> None:
    ball = Instance(trimesh.creation.icosphere(3, 2.0).triangles + place, Material(), motion=motion)
    found = trees([ball])
    normal = np.cross(found.triangles.corners[:, 1], found.triangles.corners[:, 2])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    corners = found.triangles.corners.astype(np.float64)
    middle = corners[:, 0] + (corners[:, 1] + corners[:, 2]) / 3
    lifted = [lift(found.triangles.corners, number) for number in range(len(middle))]
    above = (middle + np.array(lifted)[:, None] * normal).astype(np.float32)
    assert not found.occluded(above, normal, reach(len(above))).any()
    assert found.occluded(above, -normal, reach(len(above))).all()


def test_a_ray_on_its_way_from_a_moved_body_does_not_find_it_again() -> None:
    """How far a ray must step to leave it hangs on where the body is now."""
    far = Motion.sliding([0.0, 1.0], [(0, 0, 0), (5000, 3000, 1000)])
    ball = Instance(trimesh.creation.icosphere(3, 1.0).triangles, INVISIBLE, motion=far)
    found = trees([ball, Instance(ball.corners, Material())], 1.0)
    origin, direction = rows((5000.1, 3010, 1000.2)), rows(DOWN)
    assert not found.occluded(origin, direction, reach(1)).any()
    assert found.intersect(origin, direction).triangle == MISS


def test_a_ray_along_the_faces_of_a_moving_body_is_not_lost() -> None:
    # The ball of the first tree is far off; the sheet's box is flat, and rays run in the planes of its sides.
    far = Instance(trimesh.creation.icosphere(1, 0.1).triangles + 50.0, Material())
    sheet = np.array([[(0, 0, 0), (1, 0, 0), (1, 0, 1)], [(0, 0, 0), (1, 0, 1), (0, 0, 1)]], float)
    found = trees([far, Instance(sheet, Material(), motion=STILL)])
    origin = rows((0.5, 1, 0), (0, 1, 0.5), (0.5, 1, 1), (1, 1, 0.5), (0.25, 1, 0.5), (1.1, 1, 0.5))
    hits = found.intersect(origin, np.broadcast_to(np.array(DOWN, np.float32), origin.shape).copy())
    np.testing.assert_array_equal(ids(found, hits), [2, 2, 2, 2, 2, 0])


def test_there_is_nothing_within_the_clearance(quad: Callable[..., Instance]) -> None:
    found = trees([quad((0, 0, 0), (3, 0, 0), (0, 4, 0)), quad((0, 0, 0), (1, 0, 0), (0, 1, 0), CHEQUERED, STILL)])
    assert found.clearance((1.0, 1.0, 100.0)) == pytest.approx(95)
    assert found.clearance((1.0, 1.0, 5.0)) == found.clearance((1.0, 1.0, 0.0)) == 0


def test_a_ray_that_runs_along_a_hole_leaves_it_soon(quad: Callable[..., Instance], monkeypatch: Any) -> None:
    """Rounding holds it in the plane, however often it goes on by what leaves a triangle that is met head on."""
    asked = []
    real = Tree.nearest
    monkeypatch.setattr(Tree, "nearest", lambda tree, *rays: asked.append(len(rays[0])) or real(tree, *rays))
    found = trees([quad((-9, -9, 3.4), (18, 0, 0), (0, 18, 0), INVISIBLE), quad((6, -9, -9), (0, 18, 0), (0, 0, 18))])
    hits = found.intersect(rows((0.0, 1.0, 3.4)), rows((1.0, 0.0, 1e-9)))
    assert ids(found, hits).tolist() == [2]
    np.testing.assert_allclose(hits.distance, 6, rtol=1e-4)
    assert len(asked) < 50
