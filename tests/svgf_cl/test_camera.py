"""Cameras: where they see points, what their matrices say, and the motion of what stands still between two of them."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from svgf_cl import ArgumentError, Camera, motion_from_cameras
from svgf_cl.camera import Axes
from svgf_cl.io.exr import read_attributes
from tests.camera_headers import HABITS, header

SHAPE = (30, 40)
ARNOLD = Path(__file__).parents[3] / "shared" / "samples" / "openexr" / "cryptomatte" / "multichannel.exr"


def turned(x: float, y: float, z: float) -> np.ndarray:
    """A (3, 3) rotation by three angles in radians, one about each axis."""
    result = np.eye(3)
    for axis, angle in enumerate((x, y, z)):
        step, (a, b) = np.eye(3), ((axis + 1) % 3, (axis + 2) % 3)
        step[a, a] = step[b, b] = math.cos(angle)
        step[a, b], step[b, a] = -math.sin(angle), math.sin(angle)
        result = step @ result
    return result


def placed(angles: tuple[float, float, float], eye: tuple[float, float, float]) -> np.ndarray:
    """A (4, 4) matrix from a camera's space into the world."""
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = turned(*angles), eye
    return matrix


def camera_at(angles: tuple[float, float, float], eye: tuple[float, float, float], fov: float = 60.0) -> Camera:
    return Camera.from_fov(placed(angles, eye), fov, SHAPE, "y", "opengl")


def parallel(angles: tuple[float, float, float], eye: tuple[float, float, float]) -> Camera:
    perspective = camera_at(angles, eye)
    return Camera(world_to_view=perspective.world_to_view, focal=(9.0, 9.0), center=(19.5, 14.5), orthographic=True)


angles = st.tuples(*[st.floats(-3, 3)] * 3)
eyes = st.tuples(*[st.floats(-5e5, 5e5)] * 3)


@pytest.mark.parametrize(
    ("axes", "right_up_forward"),
    [
        ("opengl", (1, 1, -1)),
        ("mitsuba", (-1, 1, 1)),
        ("renderman", (1, 1, 1)),
        ("opencv", (1, -1, 1)),
    ],
)
def test_axes_are_those_of_the_image(axes: Axes, right_up_forward: tuple[int, int, int]) -> None:
    camera = Camera.from_fov(np.eye(4), 90.0, (4, 8), "x", axes)
    pixels, depth = camera.project(np.multiply((1.0, 0.5, 2.0), right_up_forward))
    # 4 pixels from the middle, at (3.5, 1.5), are 1 at depth 1.
    np.testing.assert_allclose((*pixels, depth), (3.5 + 2.0, 1.5 - 1.0, 2.0), atol=1e-12)


@pytest.mark.parametrize(("fov_axis", "side"), [("x", 40), ("y", 30), ("smaller", 30), ("larger", 40)])
def test_field_of_view_spans_its_side(fov_axis: str, side: int) -> None:
    camera = Camera.from_fov(np.eye(4), 50.0, SHAPE, fov_axis)
    assert camera.focal == pytest.approx((side / 2 / math.tan(math.radians(25)),) * 2)
    assert camera.center == (19.5, 14.5)


@settings(deadline=None)
@given(angles, eyes, st.booleans(), st.integers(0, 2**32 - 1))
def test_a_point_is_seen_in_the_pixel_it_was_unprojected_from(
    turn: tuple[float, float, float], eye: tuple[float, float, float], orthographic: bool, seed: int
) -> None:
    camera = (parallel if orthographic else camera_at)(turn, eye)
    depth = np.random.default_rng(seed).uniform(0.5, 50.0, SHAPE)
    points = camera.unproject(depth)
    pixels, found = camera.project(points)
    np.testing.assert_allclose(pixels, np.indices(SHAPE)[::-1].transpose(1, 2, 0), atol=1e-6)
    np.testing.assert_allclose(found, depth, rtol=1e-8)
    np.testing.assert_allclose(camera.depth_at(points), depth, rtol=1e-8)
    origin = camera.unproject(np.full(SHAPE, 0.0)) if orthographic else np.array(eye)
    np.testing.assert_allclose(camera.depth_of(np.linalg.norm(points - origin, axis=-1)), depth, rtol=1e-8)


def test_points_behind_a_camera_are_seen_nowhere() -> None:
    for camera in (camera_at((0, 0, 0), (0, 0, 0)), parallel((0, 0, 0), (0, 0, 0))):
        pixels, depth = camera.project([(0.0, 0.0, 1.0), (1.0, 0.0, 0.0), (0.0, 0.0, -1.0)])
        np.testing.assert_array_equal(np.isnan(pixels), [[True, True], [True, True], [False, False]])
        np.testing.assert_array_equal(depth, (-1, 0, 1))


def test_unprojected_points_are_nan_where_nothing_was_hit() -> None:
    depth = np.full(SHAPE, 2.0)
    depth[0, :3] = math.inf, -math.inf, math.nan
    np.testing.assert_array_equal(
        np.isnan(camera_at((0, 0, 0), (0, 0, 0)).unproject(depth)).all(-1), ~np.isfinite(depth)
    )


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"world_to_view": np.eye(3)}, r"Camera\(world_to_view\): expected shape \(4, 4\), got shape \(3, 3\)"),
        ({"world_to_view": 2 * np.eye(4)}, r"Camera\(world_to_view\): expected a rotation and a translation without"),
        ({"world_to_view": np.diag((1, 1, 1.1, 1))}, r"expected a rotation and a translation without scale"),
        ({"world_to_view": np.diag((1, 1, math.nan, 1))}, r"expected a rotation and a translation without scale"),
        ({"world_to_view": np.eye(4) + np.eye(4, k=-3)}, r"for columns \(x, y, z, 1\)"),
        ({"focal": (1.0, 0.0)}, r"Camera\(focal\): expected two numbers > 0, got \(1.0, 0.0\)"),
        ({"focal": (1.0, math.inf)}, r"Camera\(focal\): expected two numbers > 0"),
        ({"focal": 1.0}, r"Camera\(focal\): expected two numbers > 0, got 1.0"),
        ({"center": (math.nan, 1.0)}, r"Camera\(center\): expected two numbers that are finite"),
    ],
)
def test_what_is_no_camera_is_refused(change: dict, message: str) -> None:
    with pytest.raises(ArgumentError, match=message):
        Camera(**{"world_to_view": np.eye(4), "focal": (1.0, 1.0), "center": (0.0, 0.0), **change})


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"fov_degrees": 180.0}, r"from_fov\(fov_degrees\): expected an angle in \(0, 180\) degrees, got 180.0"),
        ({"fov_degrees": math.nan}, r"from_fov\(fov_degrees\)"),
        ({"shape": (0, 4)}, r"from_fov\(shape\): expected \(height, width\) in pixels, got \(0, 4\)"),
        ({"fov_axis": "z"}, r"from_fov\(fov_axis\): expected one of x, y, smaller, larger, got 'z'"),
        ({"axes": "maya"}, r"from_fov\(axes\): expected one of opencv, opengl, mitsuba, renderman, got 'maya'"),
        ({"camera_to_world": np.eye(4) * 2}, r"from_fov\(camera_to_world\): expected a rotation"),
    ],
)
def test_what_is_no_field_of_view_is_refused(change: dict, message: str) -> None:
    with pytest.raises(ArgumentError, match=message):
        Camera.from_fov(**{"camera_to_world": np.eye(4), "fov_degrees": 40.0, "shape": SHAPE, **change})


def test_a_camera_keeps_its_own_matrix() -> None:
    matrix = np.eye(4)
    camera = Camera(world_to_view=matrix, focal=(1.0, 1.0), center=(0.0, 0.0))
    matrix[0, 3] = 7.0
    assert camera.world_to_view[0, 3] == 0.0
    with pytest.raises(ValueError, match="read-only"):
        camera.world_to_view[0, 3] = 1.0


# What renderers write


def assert_same(found: Camera, expected: Camera, tolerance: float = 1e-4) -> None:
    np.testing.assert_allclose(found.world_to_view, expected.world_to_view, atol=tolerance)
    np.testing.assert_allclose(found.focal, expected.focal, rtol=1e-5)
    np.testing.assert_allclose(found.center, expected.center, atol=1e-3)
    assert found.orthographic == expected.orthographic


@pytest.mark.parametrize("transposed", [False, True])
@pytest.mark.parametrize("habit", HABITS)
@settings(deadline=None)
@given(turn=angles, eye=st.tuples(*[st.floats(-20, 20)] * 3), shift=st.tuples(*[st.floats(-3, 3)] * 2))
def test_matrices_of_a_header_are_understood(
    habit: str, transposed: bool, turn: tuple[float, ...], eye: tuple[float, ...], shift: tuple[float, float]
) -> None:
    whole = camera_at(turn, eye)
    camera = Camera(world_to_view=whole.world_to_view, focal=whole.focal, center=(19.5 + shift[0], 14.5 + shift[1]))
    matrices = header(camera, SHAPE, **HABITS[habit])
    assert_same(Camera.from_matrices(*(m.T if transposed else m for m in matrices), SHAPE), camera)


@pytest.mark.parametrize("transposed", [False, True])
@pytest.mark.parametrize("habit", ["OpenEXR's definition", "Arnold", "pbrt"])
def test_matrices_of_an_orthographic_camera_are_understood(habit: str, transposed: bool) -> None:
    camera = parallel((0.3, -1.0, 2.0), (3.0, 4.0, -5.0))
    matrices = header(camera, SHAPE, **HABITS[habit])
    assert_same(Camera.from_matrices(*(m.T if transposed else m for m in matrices), SHAPE), camera)


@pytest.mark.parametrize("transposed", [False, True])
@pytest.mark.parametrize("habit", HABITS)
@pytest.mark.parametrize("turn", [(0, 0, 0), (0, math.pi, 0), (math.pi, 0, 0), (0, math.pi / 2, 0)])
def test_matrices_of_a_camera_at_the_origin_are_understood(
    habit: str, transposed: bool, turn: tuple[float, float, float]
) -> None:
    camera = camera_at(turn, (0, 0, 0))
    matrices = header(camera, SHAPE, **HABITS[habit])
    assert_same(Camera.from_matrices(*(m.T if transposed else m for m in matrices), SHAPE), camera)


def test_pixels_that_are_not_square_are_understood() -> None:
    camera = Camera(
        world_to_view=camera_at((1, 2, 3), (4, 5, 6)).world_to_view, focal=(30.0, 50.0), center=(19.5, 14.5)
    )
    assert_same(Camera.from_matrices(*header(camera, SHAPE), SHAPE), camera)


def test_matrices_that_are_not_of_one_camera_are_refused() -> None:
    camera, ndc = header(camera_at((1, 2, 3), (4, 5, 6)), SHAPE)
    other, _ = header(camera_at((1, 2, 2), (4, 5, 6)), SHAPE)
    with pytest.raises(ArgumentError, match=r"world_to_ndc\): expected the projection of a camera"):
        Camera.from_matrices(other, ndc, SHAPE)
    with pytest.raises(ArgumentError, match=r"world_to_camera\): expected a rotation and a translation without scale"):
        Camera.from_matrices(2 * camera, ndc, SHAPE)
    with pytest.raises(ArgumentError, match=r"world_to_ndc\): expected 4 x 4 finite numbers"):
        Camera.from_matrices(camera, ndc * math.nan, SHAPE)
    with pytest.raises(ArgumentError, match=r"world_to_ndc\): expected the projection of a camera"):
        Camera.from_matrices(camera, np.zeros((4, 4)), SHAPE)
    with pytest.raises(ArgumentError, match=r"shape\): expected \(height, width\)"):
        Camera.from_matrices(camera, ndc, (3, 0))


def test_an_optical_axis_far_from_the_middle_is_refused() -> None:
    away = Camera(world_to_view=np.eye(4), focal=(30.0, 30.0), center=(19.5 + 11.0, 14.5))
    with pytest.raises(ArgumentError, match=r"expected an optical axis near \(0, 0\) or \(0.5, 0.5\), got \(0.77"):
        Camera.from_matrices(*header(away, SHAPE), SHAPE)


def test_the_matrices_of_pbrt_are_understood_in_its_left_handed_world() -> None:
    """As its cameras.cpp makes them: columns, the smaller side of the image from 0 to 1."""
    to_world = placed((0.3, 0.2, 0.1), (1.0, 2.0, 3.0))
    camera = Camera.from_fov(to_world, 40.0, SHAPE, "smaller", "renderman")
    from_world, half = np.linalg.inv(to_world), math.tan(math.radians(20.0))
    near, far = 1e-2, 1e3
    screen = np.diag((1 / half, 1 / half, far / (far - near), 0.0))
    screen[2, 3], screen[3, 2] = -far * near / (far - near), 1.0
    ndc = np.array([(0.5, 0, 0, 0.5), (0, 0.5, 0, 0.5), (0, 0, 0.5, 0.5), (0, 0, 0, 1)]) @ screen @ from_world
    assert_same(Camera.from_matrices(from_world.astype(np.float32), ndc.astype(np.float32), SHAPE), camera)


def test_the_header_of_a_file_of_mantra_is_understood() -> None:
    """That of a frame of 1280x720 in https://github.com/ynput/ayon-houdini/issues/76, of something at the origin."""
    to_camera = [
        (-0.243232, -0.429738, -0.869577, 0.0),
        (-4.55991e-08, 0.8965, -0.443043, 0.0),
        (-0.969968, 0.107762, 0.218058, 0.0),
        (-0.49336, -0.356619, 6.48486, 1.0),
    ]
    to_ndc = [
        (-0.587216, -1.84441, -8.69577e-05, 0.869577),
        (-1.10086e-07, 3.84773, -4.43043e-05, 0.443043),
        (-2.34172, 0.462509, 2.18058e-05, -0.218058),
        (-1.19108, -1.53059, 0.000648386, -6.48486),
    ]
    camera = Camera.from_matrices(to_camera, to_ndc, (720, 1280))
    assert camera.focal == pytest.approx((1545.1, 1545.1), rel=1e-4)
    assert camera.center == pytest.approx((639.5, 359.5), abs=0.01)
    pixels, depth = camera.project([(0.0, 0.0, 0.0), (0.0, 1.0, 0.0), (-1.0, 0.0, 0.0)])
    assert depth[0] == pytest.approx(6.48486)
    assert np.all((pixels > 0) & (pixels < (1280, 720)))
    assert pixels[1, 1] < pixels[0, 1]  # up is up
    assert pixels[2, 0] > pixels[0, 0]  # its x axis is -z, and a quarter -x


@pytest.mark.skipif(not ARNOLD.exists(), reason=f"{ARNOLD} is not here")
def test_the_header_of_a_file_of_arnold_is_understood() -> None:
    attributes = read_attributes(ARNOLD)
    matrices = [np.frombuffer(attributes[name][1], "<f4").reshape(4, 4) for name in ("worldToCamera", "worldToNDC")]
    camera = Camera.from_matrices(*matrices, (128, 128))
    (fov,) = np.frombuffer(attributes["CameraFov"][1], "<f4")
    assert camera.focal == pytest.approx((64 / math.tan(math.radians(fov / 2)),) * 2, rel=1e-5)
    assert camera.center == pytest.approx((63.5, 63.5), abs=1e-3)
    # The camera looks down at the middle of the scene, its up is up.
    pixels, depth = camera.project([(0.0, 0.0, 0.0), (0.0, 0.1, 0.0)])
    assert depth[0] == pytest.approx(3.0775, abs=1e-3)
    assert pixels[1, 1] < pixels[0, 1]


# Motion

NOW, BEFORE = camera_at((0.1, 0.2, 0.0), (0.0, 1.0, 6.0)), camera_at((0.12, 0.17, 0.02), (0.3, 1.1, 5.5), fov=58.0)


def test_motion_leads_to_where_the_previous_camera_saw_the_point() -> None:
    depth = np.random.default_rng(1).uniform(1.0, 9.0, SHAPE)
    motion = motion_from_cameras(NOW, BEFORE, depth=depth)
    assert motion.dtype == np.float32
    pixels, before = BEFORE.project(NOW.unproject(depth))
    expected = np.concatenate([pixels - np.indices(SHAPE)[::-1].transpose(1, 2, 0), (before - depth)[..., None]], -1)
    assert np.abs(expected[..., :2]).max() > 1.0
    np.testing.assert_allclose(motion, expected, rtol=1e-6, atol=1e-5)


@pytest.mark.parametrize("make", [camera_at, parallel])
def test_motion_is_as_precise_far_from_the_origin(make: Callable[..., Camera]) -> None:
    away = (5e5, -5e5, 2.5e5)
    depth = np.random.default_rng(2).uniform(1.0, 9.0, SHAPE)
    eyes = np.array([(0.0, 1.0, 6.0), (0.5, 1.0, 6.0)])
    here, there = (
        motion_from_cameras(make((0.1, 0.2, 0.0), now), make((0.1, 0.2, 0.1), before), depth=depth)
        for now, before in (eyes, eyes + away)
    )
    np.testing.assert_allclose(there, here, atol=1e-6)


def test_jitter_of_positions_is_not_in_their_motion() -> None:
    """On a plane that faces both cameras, all pixels move alike wherever in the pixel the plane was hit."""
    now, before = camera_at((0, 0, 0), (0, 0, 0)), camera_at((0, 0, 0), (0.7, 0, -0.5))
    jitter = np.random.default_rng(3).uniform(-0.5, 0.5, (*SHAPE, 2))
    at = np.indices(SHAPE)[::-1].transpose(1, 2, 0) + jitter
    view = np.concatenate([(at - now.center) / now.focal * 4.0, np.full((*SHAPE, 1), 4.0)], -1)
    motion = motion_from_cameras(now, before, position=now.to_world(view))
    # From depth 4 to 3.5: away from the middle by 4 / 3.5, and to the left by 0.7.
    expected = (at - now.center) * (4.0 / 3.5 - 1.0) - (0.7 / 3.5 * now.focal[0], 0.0)
    np.testing.assert_allclose(motion[..., :2], expected, atol=1e-5)
    np.testing.assert_allclose(motion[..., 2], -0.5, atol=1e-6)


def test_where_nothing_was_hit_the_motion_is_that_of_the_rotation() -> None:
    depth = np.full(SHAPE, math.inf)
    depth[0, :4] = math.nan, -1.0, 0.0, -math.inf
    motion = motion_from_cameras(NOW, BEFORE, depth=depth)
    far = motion_from_cameras(NOW, BEFORE, depth=np.full(SHAPE, 1e9))
    np.testing.assert_allclose(motion[..., :2], far[..., :2], atol=1e-5)
    np.testing.assert_array_equal(motion[..., 2], 0.0)
    position = np.full((*SHAPE, 3), math.nan)
    np.testing.assert_array_equal(motion_from_cameras(NOW, BEFORE, position=position), motion)
    np.testing.assert_array_equal(motion_from_cameras(NOW, BEFORE, position=0 * position, depth=depth), motion)
    position[:, 5:] = NOW.unproject(np.full(SHAPE, 3.0))[:, 5:]
    mixed = motion_from_cameras(NOW, BEFORE, position=position)
    np.testing.assert_array_equal(mixed[:, :5], motion[:, :5])
    np.testing.assert_allclose(
        mixed[:, 5:], motion_from_cameras(NOW, BEFORE, depth=np.full(SHAPE, 3.0))[:, 5:], atol=1e-5
    )


def test_the_background_of_an_orthographic_camera_stands_still() -> None:
    now, before = parallel((0, 0, 0), (0, 0, 0)), parallel((0.1, 0, 0), (1, 0, 0))
    np.testing.assert_array_equal(motion_from_cameras(now, before, depth=np.full(SHAPE, math.inf)), 0.0)


def test_what_was_behind_the_previous_camera_has_no_history() -> None:
    now, before = camera_at((0, 0, 0), (0, 0, 0)), camera_at((0, 0, 0), (0, 0, -5))
    depth = np.full(SHAPE, 4.0)
    depth[3] = 6.0
    motion = motion_from_cameras(now, before, depth=depth)
    np.testing.assert_array_equal(np.isnan(motion).all(-1), depth == 4.0)
    np.testing.assert_array_equal(np.isnan(motion).any(-1), depth == 4.0)
    turned_round = camera_at((0, math.pi, 0), (0, 0, 0))
    assert np.isnan(motion_from_cameras(now, turned_round, depth=np.full(SHAPE, math.inf))).all()


@pytest.mark.parametrize(
    ("arrays", "message"),
    [
        ({}, r"motion_from_cameras\(depth\): expected an array, unless position is one, got nothing"),
        ({"depth": np.ones(4)}, r"motion_from_cameras\(depth\): expected shape \(H, W\), got shape \(4,\)"),
        ({"position": np.ones((4, 5))}, r"\(position\): expected shape \(H, W, 3\), got shape \(4, 5\)"),
        ({"position": np.ones((4, 5, 3)), "depth": np.ones((5, 4))}, r"\(depth\): expected shape \(4, 5\), got"),
    ],
)
def test_arrays_of_the_wrong_shape_are_refused(arrays: dict, message: str) -> None:
    with pytest.raises(ArgumentError, match=message):
        motion_from_cameras(NOW, BEFORE, **arrays)
