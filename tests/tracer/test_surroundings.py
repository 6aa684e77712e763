from __future__ import annotations

from collections.abc import Callable

import numpy as np

from svgf_cl_tracer.geometry import Instance
from svgf_cl_tracer.lights import PointLight, Sun
from svgf_cl_tracer.materials import Material
from svgf_cl_tracer.motion import Motion, Track
from svgf_cl_tracer.scene import Scene

ORIGIN, WHITE = (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)
SLIDE = Motion.sliding([0.0, 1.0], [(0, 0, 0), (4, 0, 0)])
DIMMED = Track([0.0, 1.0], [[1.0], [0.5]])

Quad = Callable[..., Instance]
Floor = Callable[[Material], Instance]


def test_all_positions_are_relative_to_the_origin(floor: Floor, quad: Quad) -> None:
    lamp = Material(emission=WHITE)
    parts = [
        floor(Material()),
        quad((0, 2, 0), (1, 0, 0), (0, 0, 1), lamp),
        quad((1, 2, 0), (1, 0, 0), (0, 0, 1), lamp, SLIDE),
    ]
    lights = [PointLight((5, 6, 7), WHITE), PointLight((5, 6, 7), WHITE, motion=SLIDE)]
    scene, origin = Scene(parts, lights=lights), np.array((1e7, -2e7, 3e7))
    around, world = scene.around(tuple(origin.tolist())), scene.around(ORIGIN)
    here, there = around.at(0.5), world.at(0.5)

    def first(values: np.ndarray) -> np.ndarray:
        return values[:, 0].astype(np.float64)

    np.testing.assert_allclose(first(here.tables.triangles.corners), first(there.tables.triangles.corners) - origin)
    np.testing.assert_allclose(first(around.corners_at(0.25)), first(world.corners_at(0.25)) - origin)
    np.testing.assert_allclose(here.tables.lights.point_position, there.tables.lights.point_position - origin)
    np.testing.assert_allclose(here.goals, np.subtract(there.goals, origin))
    np.testing.assert_array_equal(here.tables.triangles.normals, there.tables.triangles.normals)


def test_what_does_not_change_is_made_once(floor: Floor, quad: Quad) -> None:
    still = Scene([floor(Material())], sky=WHITE)
    assert still.around(ORIGIN).at(0.0) is still.around(ORIGIN).at(1.0)
    body = quad((0, 0, 0), (1, 0, 0), (0, 1, 0), None, SLIDE)
    moving = Scene([body, floor(Material())], sky=WHITE)
    assert moving.around(ORIGIN).at(0.0).trees.trees[0] is moving.around(ORIGIN).at(1.0).trees.trees[0]


def test_triangles_keep_their_numbers_while_they_move(floor: Floor, quad: Quad) -> None:
    """Those at rest come first, and the scene tells where each was at any time."""
    body = quad((0, 0, 0), (1, 0, 0), (0, 1, 0), None, SLIDE)
    scene = Scene([body, floor(Material()), body], sky=WHITE).around(ORIGIN)
    for time, shift in ((0.0, 0.0), (0.5, 2.0), (2.0, 4.0)):
        triangles = scene.at(time).tables.triangles
        np.testing.assert_array_equal(triangles.corners[scene.first_moving :], scene.corners_at(time))
        np.testing.assert_array_equal(triangles.corners[:2], scene.at(0.0).tables.triangles.corners[:2])
        np.testing.assert_array_equal(triangles.corners[2:, 0, 0], shift)
        np.testing.assert_array_equal(triangles.instance, (2, 2, 1, 1, 3, 3))


def test_paths_end_at_lamps_and_glass_unless_light_comes_from_outside(floor: Floor, quad: Quad) -> None:
    shining = Material(emission=WHITE)
    lamps = [quad((0, y, 0), (1, 0, 0), (0, 0, 1), shining, SLIDE) for y in (2, 3)]
    glass = quad((0, 9, 0), (1, 0, 0), (0, 0, 1), Material(transmissive=True))
    parts = [floor(Material()), *lamps, glass]
    second, first = Scene(parts).around(ORIGIN).at(0.5).goals
    np.testing.assert_allclose(first, [(2, 2, 0), (3, 3, 1)])
    np.testing.assert_allclose(second, [(0, 9, 0), (1, 9, 1)])
    for light in ({"sky": WHITE}, {"lights": [Sun((0, 1, 0), WHITE)]}):
        assert np.isinf(Scene(parts, **light).around(ORIGIN).at(0.5).goals).all()


def test_brightness_is_that_of_the_time(floor: Floor) -> None:
    scene = Scene([floor(Material(emission=(2, 4, 6), brightness=DIMMED)), floor(Material(emission=WHITE))])
    for time, factor in ((0.0, 1.0), (0.5, 0.75), (3.0, 0.5)):
        emission = scene.around(ORIGIN).at(time).tables.materials.emission
        np.testing.assert_allclose(emission, [np.multiply((2, 4, 6), factor), WHITE])
