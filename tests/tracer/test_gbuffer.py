"""The G-buffer, above all motion: world points carried along in double precision, and projected again."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
import pytest
import trimesh
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from svgf_cl.camera import Camera as PublicCamera
from svgf_cl.camera import motion_from_cameras
from svgf_cl.frame import Frame
from svgf_cl_tracer import Camera, CameraPath, Scene, Shot, render_frame
from svgf_cl_tracer.camera import ray_through
from svgf_cl_tracer.geometry import Instance
from svgf_cl_tracer.materials import Material
from svgf_cl_tracer.motion import Keyframes, Motion, Track
from svgf_cl_tracer.render import FRAME, MOMENTS
from svgf_cl_tracer.sampling import pixel_jitter, random4, stream_key
from svgf_cl_tracer.shading import LENS_DRAW, PIXEL_DRAW
from tests.tracer.estimates import still

SHAPE = (45, 80)
WHITE = (1.0, 1.0, 1.0)
PATH = CameraPath.through([Camera((0, 1, 6), (0, 0, 0)), Camera((1, 1.5, 5), (0.3, 0, 0), (0.1, 1, 0), 50.0)])
STILL = CameraPath.static(Camera((0, 1, 6), (0, 0, 0)))

Floats = NDArray[np.float64]


def turn(degrees: float) -> Keyframes:
    ends = Rotation.from_euler("zyx", [(0.0, 0.0, 0.0), (degrees, degrees / 2, 9.0)], degrees=True)
    return Keyframes(rotation=Track([0.0, 1.0], ends.as_quat()))


def shift(*way: float) -> Keyframes:
    return Keyframes(translation=Track([0.0, 1.0], [(0, 0, 0), way]))


def growth(*factor: float) -> Keyframes:
    return Keyframes(scale=Track([0.0, 1.0], [(1, 1, 1), factor]))


# Within 1 second, of which a frame takes a tenth.
MOTIONS = {
    "none": [],
    "translation": [shift(3, 1, -2)],
    "rotation": [turn(170)],
    "scale": [growth(2, 0.5, 1.5)],
    "all of them": [Keyframes(shift(3, 1, -2).translation, turn(170).rotation, growth(2, 0.5, 1.5).scale)],
    "hierarchy": [turn(100), shift(2, 0, 0), np.diag((1.0, 1.2, 0.9, 1.0)), turn(-120), growth(1.5, 1.5, 1.5)],
}


def shot(links: Sequence[Keyframes | np.ndarray], path: CameraPath = PATH) -> Shot:
    """A body that moves before a wall at rest, in 11 frames of a second."""
    torus = trimesh.creation.torus(1.2, 0.5)
    body = Instance(torus.triangles, Material(), torus.vertex_normals[torus.faces], motion=Motion(links))
    wall = trimesh.creation.box((30, 30, 1)).triangles - np.array((0, 0, 4))
    return Shot(Scene([body, Instance(wall, Material())], sky=WHITE), SHAPE, 11, path, fps=10.0)


def projected(camera: Camera, points: Floats) -> Floats:
    """Image positions and depth (N, 3) of world points (N, 3), by the camera's own definition."""
    forward = np.subtract(camera.look_at, camera.position, dtype=np.float64)
    forward /= np.linalg.norm(forward)
    right: Floats = np.cross(forward, camera.up)
    right /= np.linalg.norm(right)
    offset = points - camera.position
    x, y, depth = offset @ right, offset @ np.cross(right, forward), offset @ forward
    scale = SHAPE[0] / 2 / math.tan(math.radians(camera.fov_y / 2))
    return np.stack([x / depth * scale + (SHAPE[1] - 1) / 2, (SHAPE[0] - 1) / 2 - y / depth * scale, depth], axis=1)


def points_seen(camera: Camera, positions: Floats, depth: Floats) -> Floats:
    """World points (N, 3) at image positions (N, 2) and depths (N,): the inverse of `projected`."""
    right, up, forward = camera.basis()
    scale = SHAPE[0] / 2 / math.tan(math.radians(camera.fov_y / 2))
    x, y = (positions[:, 0] - (SHAPE[1] - 1) / 2) / scale, ((SHAPE[0] - 1) / 2 - positions[:, 1]) / scale
    return camera.position + depth[:, None] * (x[:, None] * right + y[:, None] * up + forward)


def carried(links: Sequence[Keyframes | np.ndarray], now: float, before: float, points: Floats) -> Floats:
    """Where points of the body were earlier."""
    matrix = Motion(links).matrix(before) @ np.linalg.inv(Motion(links).matrix(now))
    return points @ matrix[:3, :3].T + matrix[:3, 3]


def pixel_centres() -> Floats:
    y, x = np.mgrid[: SHAPE[0], : SHAPE[1]]
    return np.stack([x.ravel(), y.ravel()], axis=1).astype(np.float64)


def assert_motion(frame: Frame, expected: Floats) -> None:
    """That motion is (N, 3) as expected to below a thousandth of a pixel, and as much of the depth."""
    np.testing.assert_allclose(frame.motion.reshape(-1, 3), expected, atol=1e-3)


def public(camera: Camera) -> PublicCamera:
    """The same camera as users of the library have it."""
    view = np.eye(4)
    view[:3, :3] = camera.basis() * ((1.0,), (-1.0,), (1.0,))  # right, down, forward
    view[:3, 3] = -view[:3, :3] @ camera.position
    scale, center = camera.lens(SHAPE).scale, ((SHAPE[1] - 1) / 2, (SHAPE[0] - 1) / 2)
    parallel = camera.view_height > 0.0
    return PublicCamera(world_to_view=view, focal=(scale, scale), center=center, orthographic=parallel)


@pytest.mark.parametrize("jitter", [False, True])
@pytest.mark.parametrize("away", [(0.0, 0.0, 0.0), (5e5, -5e5, 2e5)], ids=["near", "far"])
@pytest.mark.parametrize("view_height", [0.0, 4.0], ids=["perspective", "orthographic"])
def test_motion_of_what_stands_still_is_that_from_cameras(
    view_height: float, away: tuple[float, float, float], jitter: bool
) -> None:
    keys = [
        replace(key, position=np.add(key.position, away), look_at=np.add(key.look_at, away), view_height=view_height)
        for key in PATH.keyframes
    ]
    body = trimesh.creation.torus(1.2, 0.5)
    scene = Scene([Instance(body.triangles + away, Material(), body.vertex_normals[body.faces])], sky=WHITE)
    sequence, number = Shot(scene, SHAPE, 3, CameraPath.through(keys)), 2
    frame = render_frame(sequence, number, jitter=jitter)
    camera, previous = public(sequence.camera(number)), public(sequence.camera(number - 1))
    x, y = pixel_jitter(number) if jitter else (0.0, 0.0)
    jittered = replace(camera, center=(camera.center[0] - x, camera.center[1] - y))
    motion = motion_from_cameras(camera, previous, position=jittered.unproject(frame.depth))
    hit = np.isfinite(frame.depth)
    assert 0.1 < hit.mean() < 0.9
    assert np.abs(frame.motion[hit]).max() > 2.0
    np.testing.assert_allclose(motion[hit], frame.motion[hit], atol=1e-4)
    if not jitter:
        by_depth = motion_from_cameras(camera, previous, depth=frame.depth)
        np.testing.assert_allclose(by_depth[hit], frame.motion[hit], atol=1e-4)
        if not view_height:
            np.testing.assert_allclose(by_depth[~hit], frame.motion[~hit], atol=1e-4)


@pytest.mark.parametrize("jitter", [False, True])
@pytest.mark.parametrize("path", [STILL, PATH], ids=["still", "moving"])
@pytest.mark.parametrize("motion", MOTIONS)
def test_motion_leads_to_where_the_point_was(motion: str, path: CameraPath, jitter: bool) -> None:
    """For camera and body together; the sub-pixel offset is in the point that was hit, but in neither position."""
    sequence, number = shot(MOTIONS[motion], path), 5
    frame = render_frame(sequence, number, jitter=jitter)
    position = pixel_centres() + (pixel_jitter(number) if jitter else (0.0, 0.0))
    points = points_seen(sequence.camera(number), position, frame.depth.ravel().astype(np.float64))
    of_body = frame.id.ravel() == 1
    assert of_body.any()
    assert (frame.id == 2).any()
    points[of_body] = carried(MOTIONS[motion], 0.5, 0.4, points[of_body])
    then = projected(sequence.camera(number - 1), points)
    expected = np.concatenate([then[:, :2] - position, then[:, 2:] - frame.depth.reshape(-1, 1)], axis=1)
    if motion != "none" or path is PATH:
        assert np.abs(expected).max() > 0.5
    assert_motion(frame, expected)


@pytest.mark.parametrize("shutter", [0.0, 0.7])
@pytest.mark.parametrize("aperture", [0.0, 0.4])
@pytest.mark.parametrize("motion", ["none", "all of them", "hierarchy"])
def test_motion_through_a_lens_and_an_open_shutter_is_that_of_the_point(
    motion: str, aperture: float, shutter: float
) -> None:
    """A pixel shows a point beside its own place, at some moment; both are known from its random numbers."""
    keyframes = [Camera(c.position, c.look_at, c.up, c.fov_y, aperture, shutter) for c in PATH.keyframes]
    sequence, number = shot(MOTIONS[motion], CameraPath.through(keyframes)), 5
    frame = render_frame(sequence, number)
    motions, key = frame.motion.reshape(-1, 3), stream_key(FRAME, 0, number)
    for pixel in range(0, SHAPE[0] * SHAPE[1], 13):
        moment = int(random4(key, pixel, 0, PIXEL_DRAW)[2] * MOMENTS)
        now = number + (shutter * (moment + 0.5) / MOMENTS)
        camera, earlier = sequence.camera(now), sequence.camera(now - 1)
        x, y = pixel_centres()[pixel] + pixel_jitter(number)
        origin, way = ray_through(camera.lens(SHAPE), x, y, *random4(key, pixel, 0, LENS_DRAW)[:2])
        depth = float(frame.depth.flat[pixel])
        point = np.array([origin]) + depth / np.dot(way, camera.basis()[2]) * np.array([way])
        before = carried(MOTIONS[motion], now / 10, (now - 1) / 10, point) if frame.id.flat[pixel] == 1 else point
        np.testing.assert_allclose(
            motions[pixel], (projected(earlier, before) - projected(camera, point))[0], atol=1e-3
        )


def test_nothing_moves_at_the_first_frame() -> None:
    for shutter in (0.0, 0.5):
        keyframes = [Camera(c.position, c.look_at, c.up, c.fov_y, shutter=shutter) for c in PATH.keyframes]
        frame = render_frame(shot(MOTIONS["all of them"], CameraPath.through(keyframes)), 0)
        assert not frame.motion.any()


def test_a_still_camera_sees_no_motion_where_nothing_moves() -> None:
    frame = render_frame(shot(MOTIONS["translation"], STILL), 3)
    assert not frame.motion[frame.id == 2].any()
    assert np.abs(frame.motion[frame.id == 1]).min() > 0


def test_motion_of_the_sky_is_that_of_a_point_at_infinity(floor: Callable[[Material], Instance]) -> None:
    scene = Scene([floor(Material())], sky=WHITE)
    now = Camera((0, 1, 0), (0, 2, -1))
    moved, turned = Camera((3, 1, 2), (3, 2, 1)), Camera((0, 1, 0), (0.1, 2, -1))
    for before in (moved, turned):
        sky = render_frame(Shot(scene, SHAPE, 2, CameraPath.through([before, now])), 1, jitter=False)
        assert (sky.id == 0).all()
        far = points_seen(now, pixel_centres(), np.ones(SHAPE[0] * SHAPE[1])) - now.position
        expected = projected(before, before.position + far)[:, :2] - pixel_centres()
        np.testing.assert_allclose(sky.motion.reshape(-1, 3)[:, :2], expected, atol=1e-3)
        assert not sky.motion[..., 2].any()


def test_what_was_behind_the_camera_comes_from_far_outside(floor: Callable[[Material], Instance]) -> None:
    path = CameraPath.through([Camera((0, 1, -40), (0, 1, -50)), Camera((0, 1, 0), (0, 0.5, -10))])
    frame = render_frame(Shot(Scene([floor(Material())], sky=WHITE), SHAPE, 2, path), 1)
    behind = (frame.id == 1) & (frame.depth < 30)
    assert behind.any()
    assert np.abs(frame.motion[behind][:, :2]).min() > 1e5
    assert np.isfinite(frame.motion).all()


def test_depth_is_along_the_axis(quad: Callable[..., Instance]) -> None:
    wall = quad((-9, -9, -3), (18, 0, 0), (0, 18, 0))
    frame = still(Scene([wall], sky=WHITE), Camera((0, 0, 1), (0, 0, 0), fov_y=60.0), SHAPE)
    np.testing.assert_allclose(frame.depth, 4.0, rtol=1e-6)


def test_normals_are_unit_and_look_at_the_viewer() -> None:
    frame = render_frame(shot(MOTIONS["all of them"]), 5, jitter=False)
    normal = frame.normal.reshape(-1, 3)
    np.testing.assert_allclose(np.linalg.norm(normal, axis=1), 1, atol=1e-5)
    camera = shot([]).camera(5)
    assert ((normal * (points_seen(camera, pixel_centres(), np.ones(len(normal))) - camera.position)).sum(1) < 0).all()


def test_nothing_hit(floor: Callable[[Material], Instance]) -> None:
    frame = still(Scene([floor(Material())], sky=(1.0, 2.0, 3.0)), Camera((0, 1, 0), (0, 3, -1)), SHAPE)
    values = {"normal": 0, "depth": np.inf, "id": 0, "albedo": 1, "roughness": 1, "hit_distance": 0, "motion": 0}
    for name, value in values.items():
        np.testing.assert_array_equal(getattr(frame, name), value, name)
    np.testing.assert_array_equal(frame.color, np.broadcast_to((1.0, 2.0, 3.0), (*SHAPE, 3)))
    np.testing.assert_array_equal(frame.emission, frame.color)


def test_ids_count_the_instances_from_one() -> None:
    """In the order they were given, whatever order they are kept in."""
    mask = np.full((1, 1, 4), 255, np.uint8)
    kinds = [
        (Material(base_texture=mask, alpha_cutoff=0.5), None),
        (Material(), Motion([])),
        (Material(base_texture=mask, alpha_cutoff=0.5), Motion([])),
        (Material(), None),
    ]
    balls = [
        Instance(trimesh.creation.icosphere(2, 0.4).triangles + np.array((x, 0.0, 0.0)), material, motion=motion)
        for x, (material, motion) in zip((-1.5, -0.5, 0.5, 1.5), kinds, strict=True)
    ]
    frame = still(Scene(balls, sky=WHITE), Camera((0, 0, 5), (0, 0, 0)), SHAPE)
    row = frame.id[SHAPE[0] // 2]
    assert frame.id.dtype == np.uint32
    np.testing.assert_array_equal(row[np.flatnonzero(np.diff(row, prepend=0))], (1, 0, 2, 0, 3, 0, 4, 0))


def test_albedo_and_roughness_are_the_materials(floor: Callable[[Material], Instance]) -> None:
    camera = Camera((0, 1, 0), (0.3, 0, -0.2), fov_y=1.0)

    def seen(material: Material) -> tuple[np.ndarray, float]:
        frame = still(Scene([floor(material)], sky=WHITE), camera, (1, 1))
        return frame.albedo[0, 0], float(frame.roughness[0, 0])

    albedo, roughness = seen(Material((0.5, 0.25, 0.75), roughness=0.6))
    np.testing.assert_allclose(albedo, (0.5, 0.25, 0.75))
    assert roughness == pytest.approx(0.6)
    albedo, roughness = seen(Material((1.0, 0.7, 0.3), metallic=1.0, roughness=0.0))
    np.testing.assert_allclose(albedo, (1.0, 0.7, 0.3), atol=0.01)
    assert roughness == 0.0
    albedo, roughness = seen(Material((0.5, 0.25, 0.75), transmissive=True, roughness=0.6, ior=1.5))
    np.testing.assert_array_equal(albedo, 1)
    assert roughness == 0.0
    image = np.zeros((2, 2, 3), np.uint8)
    image[..., 1] = 255
    albedo, _ = seen(Material((0.5, 0.25, 0.75), base_texture=image))
    np.testing.assert_allclose(albedo, (0, 0.25, 0), atol=1e-6)


def test_albedo_is_what_is_reflected_of_a_white_sky(floor: Callable[[Material], Instance]) -> None:
    """So light divided by it is 1, whatever the material."""
    material = Material((0.9, 0.4, 0.1), roughness=0.4, metallic=0.3, ior=1.5)
    frame = still(Scene([floor(material)], sky=WHITE), Camera((0.9, 0.5, 0), (0, 0, 0), fov_y=0.01), bounces=0)
    np.testing.assert_allclose(frame.color.mean((0, 1)), frame.albedo.mean((0, 1)), rtol=0.01)
