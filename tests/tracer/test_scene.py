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
from svgf_cl_tracer.motion import Keyframes, Motion, Track, translation
from svgf_cl_tracer.render import render_frame
from svgf_cl_tracer.scene import Scene
from svgf_cl_tracer.shot import Shot
from svgf_cl_tracer.sky import Environment

BLACK, WHITE = (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)
SLIDE = Motion.sliding([0.0, 1.0], [(0, 0, 0), (4, 0, 0)])
FLIGHT = [0.0, 1.0], [(0, 0, 0), (0, 100, 0)]
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
    assert Scene([ground], lights=[Sun((0, 1, 0), WHITE, motion=SLIDE)]).changes
    assert Scene([quad((0, 0, 0), (1, 0, 0), (0, 1, 0), None, SLIDE)], lights=[sun]).changes
    assert Scene([floor(Material(emission=WHITE, brightness=DIMMED))]).changes


def test_the_default_camera_sees_where_things_move(quad: Quad) -> None:
    """Also what has no size at first, wherever that is."""
    grown = Keyframes(scale=Track([1.0, 2.0], [(0, 0, 0), (4, 2, 1)]))
    for place in ((0.0, 0.0, 0.0), (1e7, 1e7, 1e7)):
        motion = Motion([translation(place), grown])
        camera = Scene([quad((-1, -1, 0), (2, 0, 0), (0, 2, 0), None, motion)], sky=WHITE).camera_path.at(0.0)
        x, y, depth = project(camera.lens((100, 100)), tuple(np.subtract(np.add(place, (4, 2, 0)), camera.position)))
        assert 60 < x < 99.5
        assert -0.5 < y < 40
        assert depth > 0


def test_the_latest_surroundings_are_kept(floor: Floor) -> None:
    scene = Scene([floor(Material())], sky=WHITE)
    first = scene.around((0.0, 0.0, 0.0))
    assert scene.around((0.0, 0.0, 0.0)) is first
    assert scene.around((1.0, 0.0, 0.0)) is not first


def test_the_nearest_point_is_in_the_box_of_the_time(floor: Floor, quad: Quad) -> None:
    scene = Scene([floor(Material()), quad((0, 0, 0), (1, 0, 0), (0, 9, 0), None, Motion.sliding(*FLIGHT))], sky=WHITE)
    np.testing.assert_allclose(scene.nearest((3.0, 4.0, 5.0), 0.0), (3, 4, 5))
    np.testing.assert_allclose(scene.nearest((3.0, 40.0, 90.0), 0.0), (3, 9, 50))
    np.testing.assert_allclose(scene.nearest((3.0, 40.0, 90.0), 1.0), (3, 40, 50))


def test_details_are_as_large_as_most_triangles_are_across(quad: Quad) -> None:
    small = [quad((x, 0, 0), (0.5, 0, 0), (0, 2, 0)) for x in range(5)]
    assert Scene([*small, quad((0, 0, 0), (1e6, 0, 0), (0, 1e6, 0))], sky=WHITE).detail == 0.5


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
