from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from svgf_cl_tracer.errors import SceneError
from svgf_cl_tracer.geometry import Instance, Triangles, cofactors, corners_of, interpolated, mirrors, surface_at
from svgf_cl_tracer.materials import Material
from svgf_cl_tracer.motion import Keyframes, Motion, Track

DOWN, UP = (0.0, -1.0, 0.0), (0.0, 1.0, 0.0)
BALL = trimesh.creation.icosphere(2)
SMOOTH = Instance(BALL.triangles, Material(), BALL.vertex_normals[BALL.faces])
MASK = np.zeros((2, 2, 4), np.uint8)

matrices = st.lists(st.floats(-2, 2), min_size=9, max_size=9).map(lambda values: np.reshape(values, (3, 3)))


def moved(instance: Instance, *links: Keyframes | np.ndarray) -> Instance:
    return Instance(instance.corners, instance.material, instance.normals, instance.uv, Motion(links))


def resized(*scale: float) -> Keyframes:
    return Keyframes(scale=Track([0.0], [scale]))


def tilted(*normals: tuple[float, float, float]) -> Triangles:
    """One triangle in the plane y = 0, face up, with normals at its corners."""
    corners = np.array([[(0.0, 0.0, 0.0), (0.0, 0.0, 1.0), (1.0, 0.0, 0.0)]])
    return Triangles.of([Instance(corners, Material(), np.array([normals]))], [1], [0], 0.0)


def test_an_instance_is_masked_where_both_image_and_cutoff_are_given() -> None:
    corners = np.zeros((1, 3, 3))
    assert Instance(corners, Material(base_texture=MASK, alpha_cutoff=0.5)).masked
    assert not Instance(corners, Material(base_texture=MASK)).masked
    assert not Instance(corners, Material(alpha_cutoff=0.5)).masked


@pytest.mark.parametrize(
    ("wrong", "named"),
    [
        ({"corners": np.zeros((2, 3))}, r"corners of shape \(2, 3, 3\), got \(2, 3\)"),
        ({"normals": np.zeros((1, 3, 3))}, r"normals of shape \(2, 3, 3\), got \(1, 3, 3\)"),
        ({"colours": np.zeros((2, 3, 4))}, r"colours of shape \(2, 3, 3\), got \(2, 3, 4\)"),
        ({"uv": np.zeros((2, 3, 3))}, r"uv of shape \(2, 3, 2\), got \(2, 3, 3\)"),
    ],
)
def test_arrays_of_another_shape_are_named(wrong: dict, named: str) -> None:
    with pytest.raises(SceneError, match=named):
        Instance(**{"corners": np.zeros((2, 3, 3)), "material": Material()} | wrong)


def test_motion_carries_corners() -> None:
    slide = Motion.sliding([0.0, 1.0], [(0, 0, 0), (2, 4, 6)])
    body = moved(SMOOTH, *slide.links, resized(1.0, 2.0, 3.0))
    np.testing.assert_allclose(body.corners_at(0.5), SMOOTH.corners * (1, 2, 3) + (1, 2, 3))


@pytest.mark.parametrize("scale", [(1.0, 1.0, 1.0), (1.0, 5.0, 0.2), (1e-3, 1e-3, 1e-3), (-1.0, 1.0, 1.0)])
def test_normals_stay_across_their_surface_however_it_is_stretched(scale: tuple[float, float, float]) -> None:
    flat = Instance(BALL.triangles, Material())
    turn = Motion.turning((0, 0, 0), (1, 2, 3), [0.0], [70.0])
    expected = moved(flat, *turn.links, resized(*scale)).normals_at(0.0)
    face = np.repeat(flat.normals_at(0.0)[:, :1], 3, axis=1)
    found = moved(Instance(BALL.triangles, Material(), face), *turn.links, resized(*scale)).normals_at(0.0)
    np.testing.assert_allclose(found, expected, atol=1e-9)


@given(matrices)
def test_cofactors_are_the_inverse_transpose_up_to_length(matrix: np.ndarray) -> None:
    if abs(np.linalg.det(matrix)) < 1e-3:
        return
    expected = np.linalg.det(matrix) * np.linalg.inv(matrix).T
    found = cofactors(matrix)
    np.testing.assert_allclose(found * np.abs(matrix).max() ** 2, expected, atol=1e-9)


def test_a_body_without_thickness_has_normals_too() -> None:
    flattened = moved(SMOOTH, resized(1.0, 0.0, 1.0))
    normals = flattened.normals_at(0.0)
    assert np.isfinite(normals).all()
    np.testing.assert_allclose(np.abs(normals[SMOOTH.normals[..., 1] > 0.1, 1]), 1.0)


def test_triangles_know_where_they_come_from(floor: Callable[..., Instance]) -> None:
    found = Triangles.of([floor(Material()), SMOOTH], [3, 1], [0, 7], 0.0)
    np.testing.assert_array_equal(found.instance, [3] * 2 + [1] * len(SMOOTH.corners))
    np.testing.assert_array_equal(found.material, [0] * 2 + [7] * len(SMOOTH.corners))
    assert found.instance.dtype == np.uint32
    np.testing.assert_array_equal(found.uv[2:], 0)


def test_what_has_no_colours_is_white_beside_what_has(floor: Callable[..., Instance]) -> None:
    plain, colours = floor(Material()), np.random.default_rng(1).random((2, 3, 3))
    found = Triangles.of([plain, replace(plain, colours=colours)], [1, 2], [0, 0], 0.0).colours
    for corner, (b, c) in enumerate([(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)]):
        np.testing.assert_allclose(interpolated(found, 0, b, c), (1, 1, 1))
        np.testing.assert_allclose(interpolated(found, 3, b, c), colours[1, corner], atol=1e-6)
    assert len(Triangles.of([plain], [1], [0], 0.0).colours) == 0, "no memory where there are none"


@given(matrices)
def test_a_thing_at_rest_is_what_it_was_at_that_time(matrix: np.ndarray) -> None:
    """Its corners run counter-clockwise again where it is mirrored, and what is given at corners goes with them."""
    placed = np.eye(4)
    placed[:3, :3] = matrix
    body = moved(Instance(BALL.triangles, Material(), SMOOTH.normals, BALL.triangles[..., :2]), placed)
    rest = body.at_rest(0.0)
    turned = bool(np.linalg.det(matrix) < -1e-9)
    if abs(np.linalg.det(matrix)) > 1e-9:
        assert body.mirrored_at(0.0) == turned
    order = [2, 1, 0] if body.mirrored_at(0.0) else [0, 1, 2]
    assert not rest.mirrored_at(0.0)
    np.testing.assert_array_equal(rest.corners, body.corners_at(0.0)[:, order])
    np.testing.assert_array_equal(rest.normals, body.normals_at(0.0)[:, order])
    np.testing.assert_array_equal(rest.uv, body.uv[:, order])


@settings(deadline=None)
@given(st.tuples(*[st.floats(-180, 180)] * 3), st.integers(0, 2))
def test_a_flattening_transform_does_not_mirror(degrees: tuple[float, float, float], axis: int) -> None:
    """Between two turns rounding leaves it a determinant beside 0."""
    turn = Rotation.from_euler("xyz", degrees, degrees=True).as_matrix()
    flat = np.diag([0.0 if axis == index else 1.0 for index in range(3)])
    matrix = np.eye(4)
    matrix[:3, :3] = turn @ flat @ turn.T
    assert not mirrors(matrix)


def test_the_front_of_a_mirrored_thing_goes_with_it(floor: Callable[..., Instance]) -> None:
    over = moved(floor(Material()), resized(1.0, -1.0, 1.0))
    assert not surface_at(Triangles.of([over], [1], [0], 0.0), 0, 0.25, 0.5, DOWN).front
    aside = moved(floor(Material()), resized(-1.0, 1.0, 1.0))
    assert surface_at(Triangles.of([aside], [1], [0], 0.0), 0, 0.25, 0.5, DOWN).front


@settings(deadline=None)
@given(matrices, st.floats(0, 1))
def test_the_box_holds_what_moves(matrix: np.ndarray, time: float) -> None:
    placed = np.eye(4)
    placed[:3, :3] = matrix
    body = moved(SMOOTH, placed, *Motion.sliding([0.0, 1.0], [(0, 0, 0), (4, 0, 0)]).links)
    low, high = body.box_at(time)
    corners = body.corners_at(time).reshape(-1, 3)
    assert (low <= corners.min(0) + 1e-9).all()
    assert (high >= corners.max(0) - 1e-9).all()


def test_the_last_triangles_move(floor: Callable[..., Instance]) -> None:
    body = moved(SMOOTH, *Motion.sliding([0.0, 1.0], [(0, 0, 0), (4, 0, 0)]).links)
    parts = [floor(Material()), body]
    found = Triangles.of(parts, [1, 2], [0, 0], 0.0).moved([body], 0.5)
    for values, expected in zip(found, Triangles.of(parts, [1, 2], [0, 0], 0.5), strict=True):
        np.testing.assert_array_equal(values, expected)


def test_triangles_are_kept_as_a_corner_and_two_edges(floor: Callable[..., Instance]) -> None:
    found = Triangles.of([floor(Material())], [1], [0], 0.0)
    np.testing.assert_array_equal(found.corners[0], [(-50, 0, 50), (100, 0, 0), (100, 0, -100)])
    np.testing.assert_array_equal(found.corners, corners_of([floor(Material())], 0.0))
    np.testing.assert_array_equal(interpolated(found.corners, 0, 0.25, 0.5), (25, 0, -25 + 25))
    assert not len(Triangles.of([], [], [], 0.0).corners)


def test_both_normals_look_to_where_the_ray_came_from(floor: Callable[..., Instance]) -> None:
    triangles = Triangles.of([floor(Material())], [1], [4], 0.0)
    for direction, side in ((DOWN, 1.0), (UP, -1.0)):
        surface = surface_at(triangles, 0, 0.25, 0.5, direction)
        assert surface.normal == surface.face_normal == (0.0, side, 0.0)
        assert surface.front == (side > 0)
        assert surface.point == (25.0, 0.0, 0.0)
        assert (surface.u, surface.v) == (0.75, 0.5)
        assert surface.material == 4


def test_smooth_normals_are_interpolated_and_made_unit() -> None:
    triangles = tilted((0.6, 0.8, 0.0), (-0.6, 0.8, 0.0), (0.0, 0.8, 0.6))
    np.testing.assert_allclose(surface_at(triangles, 0, 0.5, 0.0, DOWN).normal, (0, 1, 0), atol=1e-6)
    np.testing.assert_allclose(
        surface_at(triangles, 0, 0.0, 0.5, DOWN).normal, np.array((0.3, 0.8, 0.3)) / np.sqrt(0.82), atol=1e-6
    )


def test_shading_normals_that_look_away_from_the_ray_give_way_to_the_faces() -> None:
    triangles = tilted(*[(0.6, 0.8, 0.0)] * 3)
    np.testing.assert_allclose(surface_at(triangles, 0, 0.2, 0.2, (0.0, -1.0, 0.0)).normal, (0.6, 0.8, 0.0))
    assert surface_at(triangles, 0, 0.2, 0.2, (0.96, -0.28, 0.0)).normal == (0.0, 1.0, 0.0)


def test_shading_normals_that_look_below_the_face_are_turned() -> None:
    surface = surface_at(tilted(*[(0.0, -1.0, 0.0)] * 3), 0, 0.2, 0.2, DOWN)
    np.testing.assert_array_equal(surface.normal, (0, 1, 0))


@pytest.mark.parametrize("normal", [(0.0, 0.0, 0.0), (np.nan, 0.0, 0.0)])
def test_shading_normals_that_are_none_give_way_to_the_faces(normal: tuple[float, float, float]) -> None:
    assert surface_at(tilted(*[normal] * 3), 0, 0.2, 0.2, DOWN).normal == (0.0, 1.0, 0.0)


@settings(deadline=None)
@given(st.integers(0, len(BALL.faces) - 1), st.floats(0, 1), st.floats(0, 1), st.tuples(*[st.floats(-1, 1)] * 3))
def test_normals_are_unit_and_on_the_rays_side(number: int, b: float, c: float, direction: tuple) -> None:
    length = np.linalg.norm(direction)
    if length < 1e-3:
        return
    direction = tuple(np.divide(direction, length).tolist())
    triangles = Triangles.of([SMOOTH], [1], [0], 0.0)
    surface = surface_at(triangles, number, b * (1.0 - c), c, direction)
    for normal in (surface.normal, surface.face_normal):
        assert np.linalg.norm(normal) == pytest.approx(1.0)
        assert np.dot(normal, direction) <= 1e-15  # rounding
    assert np.dot(surface.normal, surface.face_normal) > 0.0
