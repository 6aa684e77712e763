from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from svgf_cl_tracer.camera import OUTSIDE, Camera, CameraPath, CarriedCamera, Lens, project, ray_through
from svgf_cl_tracer.errors import SceneError
from svgf_cl_tracer.motion import Keyframes, Motion, Track, translation

AHEAD = Camera((0, 0, 0), (0, 0, -1), fov_y=90.0)
SHAPE = (240, 320)


def direction(camera: Camera, x: float, y: float, shape: tuple[int, int]) -> np.ndarray:
    """The direction of the ray through an image position, at depth 1."""
    _, way = ray_through(camera.lens(shape), x, y, 0.0, 0.0)
    return way / np.dot(way, camera.basis()[2])


def seen(lens: Lens, point: np.ndarray) -> np.ndarray:
    """Where a point of the world is seen, (x, y, depth)."""
    return np.array(project(lens, tuple(np.subtract(point, lens.position).tolist())))


def test_the_middle_of_the_image_looks_ahead() -> None:
    np.testing.assert_allclose(direction(AHEAD, 2.0, 1.0, (3, 5)), (0, 0, -1), atol=1e-12)


def test_rows_run_down_and_columns_to_the_right() -> None:
    first, last = direction(AHEAD, 0.0, 0.0, (2, 4)), direction(AHEAD, 3.0, 1.0, (2, 4))
    assert first[0] < 0 < last[0]
    assert first[1] > 0 > last[1]


def test_the_field_of_view_spans_the_height() -> None:
    np.testing.assert_allclose(direction(AHEAD, 0.0, -0.5, (8, 1)), (0, 1, -1), atol=1e-12)


@settings(deadline=None)  # the first call compiles
@given(
    st.tuples(*[st.floats(-5, 5)] * 3), st.floats(-30, 400), st.floats(-30, 300), st.floats(0.1, 100), st.floats(1, 150)
)
def test_project_finds_where_a_ray_went_through(
    position: tuple[float, float, float], x: float, y: float, depth: float, fov: float
) -> None:
    camera = Camera(position, (7, 8, 9), (0.1, 1, 0.2), fov)
    point = position + depth * direction(camera, x, y, SHAPE)
    np.testing.assert_allclose(seen(camera.lens(SHAPE), point), (x, y, depth), rtol=1e-9, atol=1e-7)


@settings(deadline=None)
@given(st.floats(-30, 400), st.floats(-30, 300), st.floats(0.1, 100), st.floats(0.1, 100))
def test_rays_of_an_orthographic_camera_are_parallel(x: float, y: float, depth: float, view_height: float) -> None:
    camera = Camera((1, 2, 3), (7, 8, 9), (0.1, 1, 0.2), view_height=view_height)
    lens = camera.lens(SHAPE, 0.5)
    origin, way = ray_through(lens, x, y, 0.0, 0.0)
    np.testing.assert_allclose(way, camera.basis()[2])
    np.testing.assert_allclose(seen(lens, np.add(origin, depth * np.array(way))), (x, y, depth), rtol=1e-9, atol=1e-7)
    above, _ = ray_through(lens, x, y - SHAPE[0], 0.0, 0.0)
    np.testing.assert_allclose(np.subtract(above, origin), camera.basis()[1] * view_height, atol=1e-9)


@pytest.mark.parametrize("wrong", [{"view_height": -1.0}, {"view_height": math.nan}, {"view_height": 1, "aperture": 1}])
def test_orthographic_cameras_have_a_height_and_no_lens(wrong: dict[str, float]) -> None:
    with pytest.raises(SceneError, match="expected a view_height >= 0, and beside one above 0 no aperture"):
        Camera((0, 0, 0), (0, 0, -1), **wrong)


def test_a_path_is_of_cameras_of_one_kind() -> None:
    with pytest.raises(SceneError, match="expected cameras in perspective or orthographic ones, got both"):
        CameraPath.through([AHEAD, Camera((0, 0, 0), (0, 0, -1), view_height=1.0)])


@pytest.mark.parametrize("behind", [(0.0, 0.0, 1.0), (1.0, 0.0, 0.0)])
def test_points_behind_the_camera_land_outside(behind: tuple[float, float, float]) -> None:
    assert project(AHEAD.lens((9, 9)), behind)[:2] == (OUTSIDE, OUTSIDE)


@settings(deadline=None)
@given(st.floats(0, 319), st.floats(0, 239), st.floats(0, 0.999), st.floats(0, 0.999))
def test_rays_through_all_of_the_lens_meet_in_the_plane_of_focus(x: float, y: float, u: float, v: float) -> None:
    camera = Camera((1, 2, 3), (4, 0, -1), aperture=0.5)
    lens, forward = camera.lens(SHAPE), camera.basis()[2]
    origin, way = ray_through(lens, x, y, u, v)
    assert math.dist(origin, camera.position) <= 0.25 + 1e-12
    assert np.dot(np.subtract(origin, camera.position), forward) == pytest.approx(0.0, abs=1e-12)
    in_focus = np.add(origin, np.multiply(way, math.dist((1, 2, 3), (4, 0, -1)) / np.dot(way, forward)))
    np.testing.assert_allclose(seen(lens, in_focus)[:2], (x, y), atol=1e-6)


def test_the_lens_is_sampled_evenly() -> None:
    lens = Camera((0, 0, 0), (0, 0, -1), aperture=2.0).lens(SHAPE)
    u = (np.mgrid[:64, :64].reshape(2, -1).T + 0.5) / 64
    origins = np.array([ray_through(lens, 0.0, 0.0, a, b)[0] for a, b in u.tolist()])
    np.testing.assert_allclose(origins.mean(0), 0, atol=1e-6)
    np.testing.assert_allclose(origins.T @ origins / len(origins), np.diag((0.25, 0.25, 0.0)), atol=1e-3)


@pytest.mark.parametrize("distance", [2.0, 7.0, 50.0])
def test_a_pixel_covers_the_circle_of_confusion_of_a_thin_lens(distance: float) -> None:
    camera = Camera((0, 0, 0), (0, 0, -4), aperture=0.5)
    lens = camera.lens(SHAPE)
    points = []
    for v in np.linspace(0.0, 1.0, 90, endpoint=False):
        origin, way = ray_through(lens, 100.0, 50.0, 1.0 - 1e-12, v)
        points.append(seen(lens, np.add(origin, np.multiply(way, distance / -way[2]))))
    x, y, depth = np.array(points).T
    np.testing.assert_allclose(depth, distance)
    # Similar triangles: the lens seen from the point, at the distance of the plane of focus.
    expected = 0.5 * abs(distance - 4.0) / (4.0 * distance) * lens.scale
    np.testing.assert_allclose([np.ptp(x), np.ptp(y)], expected, rtol=2e-3)
    np.testing.assert_allclose([x.mean(), y.mean()], (100.0, 50.0), atol=1e-6)


@pytest.mark.parametrize(
    ("text", "camera"),
    [
        ("0,1,2/3,4,5", Camera((0, 1, 2), (3, 4, 5))),
        ("0,1,2/3,4,5/60", Camera((0, 1, 2), (3, 4, 5), fov_y=60)),
        ("0,1,2/3,4,5/60/0,0,1", Camera((0, 1, 2), (3, 4, 5), (0, 0, 1), 60)),
        (" -1e1, .5, 2 / 3, 4, 5 / 60", Camera((-10, 0.5, 2), (3, 4, 5), fov_y=60)),
    ],
)
def test_parse(text: str, camera: Camera) -> None:
    assert Camera.parse(text) == camera


@pytest.mark.parametrize("text", ["", "1,2,3", "1,2/3,4,5", "a,b,c/1,2,3", "1,2,3/4,5,6/7/8", "1,2,3/4,5,6/7,8"])
def test_parse_says_what_it_expected(text: str) -> None:
    with pytest.raises(SceneError, match="expected 'px,py,pz/lx,ly,lz/fov'"):
        Camera.parse(text)


@pytest.mark.parametrize("fov", [0.0, 180.0, -1.0, float("nan")])
def test_fields_of_view_out_of_range_are_refused(fov: float) -> None:
    with pytest.raises(SceneError, match="field of view"):
        Camera((0, 0, 0), (0, 0, -1), fov_y=fov)


@pytest.mark.parametrize("look_at", [(0, 0, 0), (0, 2, 0)])
def test_views_that_span_no_image_are_refused(look_at: tuple[float, float, float]) -> None:
    with pytest.raises(SceneError, match="up direction"):
        Camera((0, 0, 0), look_at)


@pytest.mark.parametrize(
    "wrong", [{"aperture": -0.1}, {"aperture": math.nan}, {"shutter": -0.1}, {"shutter": 1.1}, {"shutter": math.nan}]
)
def test_lenses_and_shutters_out_of_range_are_refused(wrong: dict[str, float]) -> None:
    with pytest.raises(SceneError, match=r"aperture >= 0 and a shutter in 0\.\.1"):
        Camera((0, 0, 0), (0, 0, -1), **wrong)


def test_a_path_passes_through_its_keyframes() -> None:
    keys = [Camera((i * i, 1, 5), (0, i, 0), (0.1 * i, 1, 0), 40 + i, 0.1 * i, 0.2 * i) for i in range(4)]
    path = CameraPath.through(keys)
    tall = CameraPath.through([Camera((i, 1, 5), (0, i, 0), view_height=i * i + 1) for i in range(4)])
    assert [tall.at(index / 3).view_height for index in range(4)] == pytest.approx([1, 2, 5, 10])
    for index, key in enumerate(keys):
        found = path.at(index / 3)
        for name in ("position", "look_at", "up", "fov_y", "aperture", "shutter"):
            np.testing.assert_allclose(getattr(found, name), getattr(key, name), atol=1e-9)


def test_two_keyframes_make_a_straight_line_at_constant_speed() -> None:
    path = CameraPath.through([Camera((0, 0, 5), (0, 0, 0)), Camera((4, 0, 5), (0, 0, 0))])
    np.testing.assert_allclose([path.at(t).position[0] for t in (0.0, 0.25, 0.5, 1.0)], (0, 1, 2, 4), atol=1e-12)


def test_a_path_stays_at_its_ends() -> None:
    path = CameraPath.through([Camera((0, 0, 5), (0, 0, 0)), Camera((4, 0, 5), (0, 0, 0))])
    assert path.at(-0.5) == path.at(0.0)
    assert path.at(1.5) == path.at(1.0)


def test_a_path_is_smooth_at_its_keyframes() -> None:
    path = CameraPath.through([Camera((x, 0, 5), (0, 0, 0)) for x in (0, 1, 4)])
    before, at, after = (path.at(0.5 + dt).position[0] for dt in (-1e-4, 0.0, 1e-4))
    assert after - at == pytest.approx(at - before, rel=1e-3)


def test_a_path_does_not_swing_out_of_the_ranges_of_lens_and_shutter() -> None:
    path = CameraPath.through([Camera((0, 0, 5), (0, 0, 0), aperture=a, shutter=a) for a in (1.0, 0.0, 0.0, 1.0, 1.0)])
    for t in np.linspace(0.0, 1.0, 41):
        assert path.at(t).aperture >= 0.0
        assert 0.0 <= path.at(t).shutter <= 1.0


def test_a_static_path_stays() -> None:
    assert CameraPath.static(AHEAD).at(0.7) is AHEAD


def test_an_empty_path_is_refused() -> None:
    with pytest.raises(SceneError, match="at least one camera"):
        CameraPath(())


def test_a_carried_camera_is_where_it_is_carried_to_whatever_its_size() -> None:
    camera = Camera((1, 0, 0), (1, 0, -3), fov_y=30.0, aperture=0.1)
    turn = Motion.turning((0, 0, 0), (0, 1, 0), [0.0, 1.0], [0.0, 90.0])
    sizes = Keyframes(scale=Track([0.0, 1.0], [(0, 0, 0), (2, 2, 2)]))
    carried = CarriedCamera(camera, Motion([translation((1e7, 0, 0)), *turn.links, sizes]))
    for time, eye, forward in ((0.0, (1e7, 0, 0), (0, 0, -1)), (1.0, (1e7, 0, -2), (-1, 0, 0))):
        found = carried.at_time(time)
        np.testing.assert_allclose(found.position, eye, atol=1e-8)
        np.testing.assert_allclose(found.basis()[1:], [(0, 1, 0), forward], atol=1e-8)
        assert np.linalg.norm(np.subtract(found.look_at, found.position)) == pytest.approx(3)
        assert (found.fov_y, found.aperture) == (30, 0.1)


@pytest.mark.parametrize("aperture", [0.0, 0.5])
def test_rays_start_within_the_clearance_on_their_way(aperture: float) -> None:
    camera = Camera((1, 2, 3), (0, 0, 0), aperture=aperture)
    for u, v in ((0.0, 0.0), (0.9, 0.3)):
        here, direction = ray_through(camera.lens((20, 30)), 7.0, 9.0, u, v)
        ahead, same = ray_through(camera.lens((20, 30), 2.0), 7.0, 9.0, u, v)
        assert same == direction
        np.testing.assert_allclose(np.subtract(ahead, here), np.multiply(direction, 2.0 - aperture), atol=1e-12)
        assert np.linalg.norm(np.subtract(ahead, camera.position)) <= 2.0 + 1e-12
