from __future__ import annotations

import pickle
from collections.abc import Callable

import numpy as np
import pytest

from svgf_cl_tracer.camera import Camera, CameraPath, project
from svgf_cl_tracer.errors import SceneError
from svgf_cl_tracer.geometry import Instance
from svgf_cl_tracer.lights import PointLight, Sun
from svgf_cl_tracer.materials import Material
from svgf_cl_tracer.motion import Motion, Track
from svgf_cl_tracer.render import render_frame
from svgf_cl_tracer.scene import Scene
from svgf_cl_tracer.shot import Shot
from svgf_cl_tracer.sky import Environment

BLACK, WHITE = (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)
SLIDE = Motion.sliding([0.0, 1.0], [(0, 0, 0), (4, 0, 0)])
ORIGIN = (0.0, 0.0, 0.0)
DIMMED = Track([0.0, 1.0], [[1.0], [0.5]])

Quad = Callable[..., Instance]
Floor = Callable[[Material], Instance]


@pytest.mark.parametrize("sky", [None, BLACK, Environment(np.zeros((2, 4, 3), np.float32))])
def test_a_scene_that_emits_nothing_offers_a_sky(floor: Floor, sky: tuple | Environment | None) -> None:
    with pytest.raises(SceneError, match="--sky"):
        Scene([floor(Material())], lights=[Sun((0, 1, 0), BLACK), PointLight((0, 1, 0), BLACK)], sky=sky)


def test_any_kind_of_light_will_do(floor: Floor) -> None:
    ground = floor(Material())
    Scene([floor(Material(emission=(0, 0, 1)))])
    Scene([ground], sky=(0, 0, 1))
    Scene([ground], sky=Environment(np.ones((2, 4, 3), np.float32)))
    Scene([ground], lights=[Sun((0, 1, 0), WHITE)])
    Scene([ground], lights=[PointLight((0, 1, 0), WHITE)])


def test_an_empty_scene_is_refused() -> None:
    with pytest.raises(SceneError, match="at least one triangle"):
        Scene([Instance(np.zeros((0, 3, 3)), Material())], sky=WHITE)


def test_numbers_that_are_not_finite_are_refused(floor: Floor) -> None:
    with pytest.raises(SceneError, match="finite vertex"):
        Scene([Instance(np.full((1, 3, 3), np.nan), Material())], sky=WHITE)
    with pytest.raises(SceneError, match="finite texture coordinates"):
        Scene([Instance(np.zeros((1, 3, 3)), Material(), uv=np.full((1, 3, 2), np.inf))], sky=WHITE)
    with pytest.raises(SceneError, match="finite vertex colours"):
        Scene([Instance(np.zeros((1, 3, 3)), Material(), colours=np.full((1, 3, 3), np.nan))], sky=WHITE)


@pytest.mark.parametrize("sky", [(-1.0, 0.0, 0.0), (np.nan, 1.0, 1.0), (np.inf, 1.0, 1.0)])
def test_skies_out_of_range_are_refused(floor: Floor, sky: tuple[float, float, float]) -> None:
    with pytest.raises(SceneError, match="sky: expected three radiances >= 0"):
        Scene([floor(Material())], sky=sky)


def test_the_default_camera_sees_every_corner(quad: Quad) -> None:
    moved = Motion.sliding([0.0], [(10, 20, 30)])
    camera = Scene([quad((3, -2, 5), (0, 4, 0), (6, 0, -9), None, moved)], sky=WHITE).camera_path.at(0.5)
    lens = camera.lens((100, 100))
    for corner in ((13, 18, 35), (13, 22, 35), (19, 18, 26), (19, 22, 26)):
        x, y, depth = project(lens, tuple(np.subtract(corner, camera.position).tolist()))
        assert depth > 0
        assert -0.5 < min(x, y) <= max(x, y) < 99.5


def test_a_scene_changes_where_anything_but_the_camera_does(floor: Floor, quad: Quad) -> None:
    ground = floor(Material())
    sun = Sun((0, 1, 0), WHITE)
    assert not Scene([ground], lights=[sun, PointLight((0, 1, 0), WHITE)], sky=WHITE).changes
    assert Scene([ground], lights=[PointLight((0, 1, 0), WHITE, motion=SLIDE)]).changes
    assert Scene([quad((0, 0, 0), (1, 0, 0), (0, 1, 0), None, SLIDE)], lights=[sun]).changes
    assert Scene([floor(Material(emission=WHITE, brightness=DIMMED))]).changes


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


def test_a_scene_can_be_sent_to_another_process(floor: Floor, quad: Quad) -> None:
    image = np.full((2, 2, 4), 200, np.uint8)
    lamp = Material(BLACK, emission=WHITE, brightness=DIMMED)
    scene = Scene(
        [
            floor(Material(base_texture=image, alpha_cutoff=0.5)),
            quad((0, 2, 0), (1, 0, 0), (0, 0, 1), lamp, SLIDE),
            quad((2, 2, 0), (1, 0, 0), (0, 0, 1), lamp),
        ],
        lights=[Sun((0, 1, 0), WHITE), PointLight((0, 1, 0), WHITE, motion=SLIDE)],
        sky=Environment(np.random.default_rng(1).random((4, 8, 3)).astype(np.float32)),
        camera_path=CameraPath.static(Camera((0, 2, 4), (0, 0, 0), shutter=0.5)),
    )
    sent = pickle.loads(pickle.dumps(Shot(scene, (16, 16), 3)))
    for number in (0, 2):
        here, there = render_frame(Shot(scene, (16, 16), 3), number), render_frame(sent, number)
        for name, value in here.present().items():
            np.testing.assert_array_equal(getattr(there, name), value)
