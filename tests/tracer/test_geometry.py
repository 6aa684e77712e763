from __future__ import annotations

from collections.abc import Callable

import numpy as np
import trimesh

from tracer.geometry import Instance, Triangles
from tracer.materials import Material

DOWN = np.array([[0.0], [-1.0], [0.0]], np.float32)


def at(*points: tuple[float, float, float]) -> np.ndarray:
    return np.array(points, np.float32).T


def test_rays_find_the_nearest_triangle(floor: Callable[[Material], Instance]) -> None:
    roof = Instance(floor(Material()).corners + np.array((0, 2, 0)), Material())
    triangles = Triangles([floor(Material()), roof], [0, 1])
    hits = triangles.intersect(at((1, 1, 2), (900, 1, 2), (1, 3, 2)), np.repeat(DOWN, 3, axis=1))
    np.testing.assert_array_equal(hits.ray, (0, 2))
    np.testing.assert_array_equal(triangles.instance[hits.triangle], (1, 2))
    np.testing.assert_allclose(triangles.positions(hits.triangle, hits.u, hits.v), [(1, 1), (0, 2), (2, 2)], atol=1e-4)


def test_occlusion_ends_at_its_reach(floor: Callable[[Material], Instance]) -> None:
    triangles = Triangles([floor(Material())], [0])
    origin = at((0.3, 1, 0.2))
    assert not triangles.occluded(origin, DOWN, reach=0.9)
    assert triangles.occluded(origin, DOWN, reach=1.1)
    assert triangles.occluded(origin, DOWN)
    assert not triangles.occluded(origin, -DOWN)


def test_both_normals_look_to_where_the_ray_came_from(floor: Callable[[Material], Instance]) -> None:
    triangles = Triangles([floor(Material())], [0])
    directions = np.concatenate([DOWN, -DOWN], axis=1)
    surface = triangles.surface(triangles.intersect(at((0, 1, 0.5), (0, -1, 0.5)), directions), directions)
    np.testing.assert_allclose(surface.normal[1], (1, -1))
    np.testing.assert_allclose(surface.face_normal[1], (1, -1))
    np.testing.assert_array_equal(surface.front, (True, False))
    assert surface.origin[1, 0] > 0 > surface.origin[1, 1]


def test_rays_that_leave_a_surface_do_not_find_it_again() -> None:
    ball = trimesh.creation.icosphere(3, 2.0)
    triangles = Triangles([Instance(ball.triangles + 10.0, Material())], [0])
    random = np.random.default_rng(3)
    direction = random.normal(size=(3, 2000)).astype(np.float32)
    origin = np.float32(10.0) - 4 * direction / np.linalg.norm(direction, axis=0)
    surface = triangles.surface(triangles.intersect(origin, direction), direction)
    assert surface.origin.shape == direction.shape
    assert not triangles.occluded(surface.origin, surface.face_normal).any()
    assert triangles.occluded(surface.origin, -surface.face_normal).all()


def test_smooth_normals_are_interpolated() -> None:
    ball = trimesh.creation.icosphere(3)
    smooth = Instance(ball.triangles, Material(), ball.vertex_normals[ball.faces])
    direction = np.array([[-0.2, 0.5], [-0.5, 0.1], [-0.7, -0.3]], np.float32)
    for instance, tolerance in ((smooth, 0.003), (Instance(ball.triangles, Material()), 0.15)):
        triangles = Triangles([instance], [0])
        surface = triangles.surface(triangles.intersect(-3 * direction, direction), direction)
        np.testing.assert_allclose(surface.normal, -direction / np.linalg.norm(direction, axis=0), atol=tolerance)
