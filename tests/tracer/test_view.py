from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
import trimesh

from svgf_cl.frame import Frame
from tracer import Camera, builtin_scene, render_frame
from tracer.geometry import Instance
from tracer.materials import Material
from tracer.sampling import pixel_jitter
from tracer.scene import Scene

SHAPE = (45, 80)
ROOM = builtin_scene()
NOW, BEFORE = ROOM.camera_path.at(0.5), ROOM.camera_path.at(0.3)


def pixels(offset: tuple[float, float] = (0.0, 0.0)) -> tuple[np.ndarray, np.ndarray]:
    y, x = np.mgrid[: SHAPE[0], : SHAPE[1]]
    return x.ravel() + offset[0], y.ravel() + offset[1]


def points(frame: Frame, offset: tuple[float, float] = (0.0, 0.0)) -> np.ndarray:
    """World points (3, N) from depth alone."""
    return np.array(NOW.position)[:, None] + frame.depth.ravel() * NOW.directions(*pixels(offset), SHAPE)


@pytest.mark.parametrize("jitter", [False, True])
def test_motion_leads_to_where_the_point_was(jitter: bool) -> None:
    frame = render_frame(ROOM, NOW, BEFORE, SHAPE, frame_index=5, jitter=jitter)
    offset = pixel_jitter(5) if jitter else (0.0, 0.0)
    x, y, depth = BEFORE.project(points(frame, offset) - np.array(BEFORE.position)[:, None], SHAPE)
    # The jitter is in the hit point, but in neither position.
    expected = np.stack([*np.subtract((x, y), pixels(offset)), depth - frame.depth.ravel()], axis=1)
    assert np.abs(expected).max() > 0.5
    np.testing.assert_allclose(frame.motion.reshape(-1, 3), expected, atol=1e-3)


def test_a_still_camera_sees_no_motion() -> None:
    for previous in (NOW, None):
        assert not render_frame(ROOM, NOW, previous, SHAPE, frame_index=3).motion.any()


def test_motion_of_the_sky_is_that_of_a_point_at_infinity(floor: Callable[[Material], Instance]) -> None:
    scene = Scene([floor(Material())], sky=(1, 1, 1))
    now = Camera((0, 1, 0), (0, 2, -1))
    moved, turned = Camera((3, 1, 2), (3, 2, 1)), Camera((0, 1, 0), (0.1, 2, -1))
    sky = render_frame(scene, now, moved, SHAPE, jitter=False)
    assert (sky.id == 0).all()
    np.testing.assert_allclose(sky.motion, 0, atol=1e-4)
    motion = render_frame(scene, now, turned, SHAPE, jitter=False).motion.reshape(-1, 3)
    x, y, _ = turned.project(now.directions(*pixels(), SHAPE), SHAPE)
    np.testing.assert_allclose(motion[:, :2], np.stack([x, y], 1) - np.stack(pixels(), 1), atol=1e-4)
    assert not motion[:, 2].any()


def test_depth_is_along_the_axis(quad: Callable[..., Instance]) -> None:
    wall = quad((-9, -9, -3), (18, 0, 0), (0, 18, 0))
    frame = render_frame(Scene([wall], sky=(1, 1, 1)), Camera((0, 0, 1), (0, 0, 0), fov_y=60.0), None, SHAPE)
    np.testing.assert_allclose(frame.depth, 4.0, rtol=1e-6)


def test_normals_are_unit_and_look_at_the_viewer() -> None:
    frame = render_frame(ROOM, NOW, None, SHAPE, jitter=False)
    normal = frame.normal.reshape(-1, 3)
    np.testing.assert_allclose(np.linalg.norm(normal, axis=1), 1, atol=1e-5)
    # A smooth normal may lean away a little at a silhouette.
    assert ((normal.T * NOW.directions(*pixels(), SHAPE)).sum(0) < 0.15).all()


def test_nothing_hit(floor: Callable[[Material], Instance]) -> None:
    scene = Scene([floor(Material())], sky=(1.0, 2.0, 3.0))
    frame = render_frame(scene, Camera((0, 1, 0), (0, 3, -1)), None, SHAPE)
    for field, value in ((frame.normal, 0), (frame.depth, np.inf), (frame.id, 0), (frame.albedo, 1)):
        assert (field == value).all()
    np.testing.assert_array_equal(frame.color, np.broadcast_to((1.0, 2.0, 3.0), (*SHAPE, 3)))
    np.testing.assert_array_equal(frame.emission, frame.color)


def test_ids_count_the_instances_from_one() -> None:
    balls = [
        Instance(trimesh.creation.icosphere(2, 0.4).triangles + np.array((x, 0.0, 0.0)), Material()) for x in (-1, 0, 1)
    ]
    frame = render_frame(Scene(balls, sky=(1, 1, 1)), Camera((0, 0, 4), (0, 0, 0)), None, SHAPE, jitter=False)
    row = frame.id[SHAPE[0] // 2]
    assert frame.id.dtype == np.uint32
    np.testing.assert_array_equal(row[np.flatnonzero(np.diff(row, prepend=0))], (1, 0, 2, 0, 3, 0))
