"""The place of a scene and its size do not matter: far from the origin and at any scale the picture is the same."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from svgf_cl import Frame
from svgf_cl_tracer import Camera, CameraPath, Environment, Scene, Shot, load_scene, render_frame
from svgf_cl_tracer.camera import CarriedCamera
from svgf_cl_tracer.geometry import Instance
from svgf_cl_tracer.lights import PointLight, Sun
from svgf_cl_tracer.materials import Material
from svgf_cl_tracer.motion import Keyframes, Motion, Track, translation

CASES = Path(__file__).parents[4] / "shared" / "cases" / "gltf"

Quad = Callable[..., Instance]
Floats = NDArray[np.float64]

SHAPE = (18, 24)
GREY, LAMP = Material((0.5, 0.6, 0.7)), Material(emission=(4.0, 3.0, 2.0))
HOLES = Material(base_texture=np.random.default_rng(1).integers(0, 256, (4, 4, 4), np.uint8), alpha_cutoff=0.5)
SKY = Environment(np.random.default_rng(2).random((4, 8, 3)).astype(np.float32))

TURN = Keyframes(
    translation=Track([0.0, 1.0], [(0.2, 0, 0), (-0.3, 0.2, 0.1)]),
    rotation=Track([0.0, 1.0], [(0, 0, 0, 1), (0, 0.6, 0, 0.8)]),
    scale=Track([0.0, 1.0], [(1, 1, 1), (1.2, 0.8, -1)]),
)
LENS = Camera((0, 0.4, 2.5), (0, 0, 0), fov_y=35.0, aperture=0.02, shutter=0.4)
CAMERAS = {
    "path": CameraPath.through([LENS, Camera((0.5, 0.6, 2.2), (0, 0.1, 0), (0.1, 1, 0), 40.0, 0.01, 0.4)]),
    "carried": CarriedCamera(LENS, Motion([TURN])),
    "orthographic": CarriedCamera(Camera((0, 0.4, 2.5), (0, 0, 0), view_height=2.0), Motion([TURN])),
}
LIGHTS = {
    "sky": {"sky": SKY},
    "sun": {"lights": [Sun((1, 2, 3), (1, 1, 1), motion=Motion([TURN]))]},
    "points": {
        "lights": [
            PointLight((0.5, 1.0, 1.0), (1, 2, 3), motion=Motion([TURN])),
            PointLight((-0.8, 0.9, 0.8), (5, 4, 3), (0.8, -0.9, -0.8), 10.0, 40.0, 3.0),
        ]
    },
    "lamps": {},
}

# What rounding in single precision leaves of depth and of motion in pixels; of the light, where few paths go otherwise.
ROUNDING = {"depth": 2e-6, "motion": 2e-4, "normal": 1e-5}


def parts(quad: Quad) -> list[Instance]:
    return [
        quad((-2, -0.5, 2), (4, 0, 0), (0, 0, -4), GREY),
        quad((-0.2, -0.2, 0.3), (0.5, 0, 0), (0, 0.5, 0), GREY, Motion([TURN])),
        quad((-0.9, -0.4, 0.1), (0.5, 0, 0), (0, 0.6, 0.1), HOLES, Motion([TURN])),
        quad((-0.1, 1.2, 0.3), (0.3, 0, 0), (0, 0, 0.3), LAMP, Motion([TURN])),
        quad((0.6, -0.5, -0.5), (0.5, 0, 0.1), (0, 0.7, 0), HOLES),
    ]


def carried(motion: Motion | None, matrix: Floats) -> Motion | None:
    return motion and Motion([matrix, *motion.links])


def placed(scene: Scene, scale: float, way: Sequence[float]) -> Scene:
    """The scene so many times as large, and then moved by `way`, in double precision."""
    matrix = translation(way) @ np.diag([scale, scale, scale, 1.0])

    def put(point: Sequence[float] | Floats) -> Floats:
        return np.multiply(point, scale) + np.asarray(way, np.float64)

    def sized(camera: Camera) -> Camera:
        return replace(camera, aperture=camera.aperture * scale, view_height=camera.view_height * scale)

    def put_camera(camera: Camera) -> Camera:
        eye, target = tuple(put(camera.position).tolist()), tuple(put(camera.look_at).tolist())
        return replace(sized(camera), position=eye, look_at=target)

    def put_light(light: Sun | PointLight) -> Sun | PointLight:
        if isinstance(light, Sun):
            return replace(light, motion=carried(light.motion, matrix))
        intensity = tuple(np.multiply(light.intensity, scale**2).tolist())
        light = replace(light, intensity=intensity, reach=light.reach * scale)
        if light.motion:
            return replace(light, motion=carried(light.motion, matrix))
        return replace(light, position=tuple(put(light.position).tolist()))

    instances = [
        replace(each, motion=carried(each.motion, matrix)) if each.motion else replace(each, corners=put(each.corners))
        for each in scene.instances
    ]
    path = scene.camera_path
    if isinstance(path, CarriedCamera):
        lens = sized(path.camera)
        # Its focus, which sizes do not change, is as far away as what it looks at.
        focus = np.multiply(np.subtract(lens.look_at, lens.position), scale)
        lens = replace(lens, look_at=tuple((lens.position + focus).tolist()))
        path = CarriedCamera(lens, carried(path.motion, matrix))
    else:
        path = CameraPath.through([put_camera(camera) for camera in path.keyframes])
    return Scene(instances, lights=[put_light(light) for light in scene.lights], sky=scene.sky, camera_path=path)


def assert_same(found: Frame, expected: Frame, scale: float = 1.0) -> None:
    seen = np.isfinite(expected.depth)
    same = (found.id == expected.id) & (np.isfinite(found.depth) == seen)
    assert same.mean() > 0.99  # rounding may show another thing at an edge
    length = {"depth": scale, "motion": np.array((1.0, 1.0, scale)), "normal": 1.0}
    for name, rounding in ROUNDING.items():
        off = getattr(found, name)[same & seen] / length[name] - getattr(expected, name)[same & seen]
        assert np.quantile(np.abs(off), 0.99) <= rounding * max(1.0, np.abs(expected.depth[seen]).max()), name
    assert np.mean(~np.isclose(found.color, expected.color, rtol=1e-3, atol=1e-4)) < 0.02


def rendered(scene: Scene, number: int) -> Frame:
    return render_frame(Shot(scene, SHAPE, 5, fps=4.0), number, spp=2)


@pytest.mark.parametrize("camera", CAMERAS)
@pytest.mark.parametrize("light", LIGHTS)
@settings(deadline=None, max_examples=4)
@given(way=st.tuples(*[st.floats(-1e7, 1e7)] * 3), number=st.integers(0, 4))
def test_far_from_the_origin(quad: Quad, camera: str, light: str, way: tuple[float, float, float], number: int) -> None:
    scene = Scene(parts(quad), camera_path=CAMERAS[camera], **LIGHTS[light])
    assert_same(rendered(placed(scene, 1.0, way), number), rendered(scene, number))


@pytest.mark.parametrize("scale", [1e-6, 1e-3, 1e3, 1e6])
@pytest.mark.parametrize("light", LIGHTS)
def test_at_any_scale(quad: Quad, light: str, scale: float) -> None:
    for camera in CAMERAS.values():
        scene = Scene(parts(quad), camera_path=camera, **LIGHTS[light])
        assert_same(rendered(placed(scene, scale, (0, 0, 0)), 2), rendered(scene, 2), scale)


@pytest.mark.parametrize("way", [(1e6, 0, 0), (1e7, -1e7, 1e7)])
def test_the_default_camera_frames_what_is_far_away(quad: Quad, way: tuple[float, float, float]) -> None:
    near = Scene(parts(quad), sky=SKY)
    far = Scene(placed(near, 1.0, way).instances, sky=SKY)
    assert_same(rendered(far, 1), rendered(near, 1))


@pytest.mark.parametrize("number", [0, 3, 4])
def test_a_camera_that_travels_far_sees_as_well_as_at_the_start(quad: Quad, number: int) -> None:
    """A road of 1,000 km with the same things at places along it, which rises as roads do."""
    way = np.array((1e6, 2e3, 5e5))
    here = Scene(parts(quad), camera_path=CameraPath.static(LENS), **LIGHTS["points"])
    stops = [placed(here, 1.0, way * share) for share in (0.0, 0.25, 0.5, 0.75, 1.0)]
    road = Scene(
        [each for stop in stops for each in stop.instances],
        lights=[each for stop in stops for each in stop.lights],
        camera_path=CameraPath.through([stop.camera_path.at(0.0) for stop in stops]),
    )
    shot = Shot(road, SHAPE, 5, CameraPath.through([replace(c, shutter=0.0) for c in road.camera_path.keyframes]), 4.0)
    alone = CameraPath.static(replace(LENS, shutter=0.0))
    found = render_frame(shot, number, spp=2)
    expected = render_frame(Shot(here, SHAPE, 5, alone, 4.0), number, spp=2)
    assert_allclose(found.depth, expected.depth, rtol=1e-4)
    assert_allclose(found.normal, expected.normal, atol=1e-4)
    assert_allclose(found.color.mean(), expected.color.mean(), rtol=0.2)


@pytest.mark.parametrize("stray", [(1e7, 0, 0), (-1e7, 1e7, 1e7)])
def test_a_stray_thing_far_away_takes_nothing_from_what_is_near(quad: Quad, stray: tuple[float, float, float]) -> None:
    scene = Scene(parts(quad), camera_path=CAMERAS["path"], sky=SKY)
    more = [*scene.instances, quad(stray, (1, 0, 0), (0, 1, 0), GREY)]
    assert_same(rendered(Scene(more, camera_path=scene.camera_path, sky=SKY), 2), rendered(scene, 2))


def test_a_camera_far_away_sees_through_a_long_lens(quad: Quad) -> None:
    """A square as seen from 1,000 km off: straight edges, motion and a shadow as from near."""
    things = [quad((-1, -1, 0), (2, 0, 0), (0, 2, 0), GREY), quad((-0.5, -0.5, 1e-3), (1, 0, 0), (0, 1, 0), GREY)]
    scene = Scene(things, lights=[Sun((1, 1, 1), (1, 1, 1), 0.0)])
    fov = 2 * np.degrees(np.arctan(1.5 / 1e6))
    frame = render_frame(Shot(scene, (90, 90), 1, CameraPath.static(Camera((0, 0, 1e6), (0, 0, 0), fov_y=fov))), 0)
    columns = (frame.id != 0).sum(0)
    assert set(columns.tolist()) == {0, 60}
    assert np.count_nonzero(columns) == 60
    assert np.count_nonzero(frame.id == 2) == 900
    assert_allclose(frame.depth[frame.id == 1], 1e6)
    assert len(np.unique(frame.direct[frame.id != 0], axis=0)) == 1


@pytest.mark.skipif(not CASES.is_dir(), reason=f"{CASES} is not there")
def test_the_case_that_was_reported() -> None:
    near, far = (
        render_frame(
            Shot(
                load_scene(CASES / f"far_{x}.gltf", (1.0, 1.0, 1.0)),
                (64, 64),
                camera_path=CameraPath.static(Camera((x, 0, 2), (x, 0, 0), fov_y=30.0)),
            ),
            0,
            spp=64,
            jitter=False,
        )
        for x in (0, 500000)
    )
    assert 0.58 < near.color[28:36, 8:14].mean() < 0.7  # the plate's shade
    assert_same(far, near)
