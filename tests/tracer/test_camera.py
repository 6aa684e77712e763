from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tracer.camera import OUTSIDE, Camera, CameraPath
from tracer.errors import SceneError

AHEAD = Camera((0, 0, 0), (0, 0, -1), fov_y=90.0)


def test_the_middle_of_the_image_looks_ahead() -> None:
    direction = AHEAD.directions(np.array([2.0]), np.array([1.0]), (3, 5))
    np.testing.assert_allclose(direction[:, 0], (0, 0, -1), atol=1e-12)


def test_rows_run_down_and_columns_to_the_right() -> None:
    x, y, _ = AHEAD.directions(np.array([0.0, 3.0]), np.array([0.0, 1.0]), (2, 4))
    assert x[0] < 0 < x[1]
    assert y[0] > 0 > y[1]


def test_the_field_of_view_spans_the_height() -> None:
    top = AHEAD.directions(np.array([0.0]), np.array([-0.5]), (8, 1))
    np.testing.assert_allclose(top[:, 0], (0, 1, -1), atol=1e-12)


@given(
    st.tuples(*[st.floats(-5, 5)] * 3),
    st.floats(-30, 400),
    st.floats(-30, 300),
    st.floats(0.1, 100),
    st.floats(1, 150),
)
def test_project_inverts_directions(
    position: tuple[float, float, float], x: float, y: float, depth: float, fov: float
) -> None:
    camera = Camera(position, (7, 8, 9), (0.1, 1, 0.2), fov)
    offset = depth * camera.directions(np.array([x]), np.array([y]), (240, 320))
    np.testing.assert_allclose(camera.project(offset, (240, 320))[:, 0], (x, y, depth), rtol=1e-9, atol=1e-7)


def test_points_behind_the_camera_land_outside() -> None:
    behind = np.array([[0.0, 1.0], [0.0, 0.0], [1.0, 0.0]])
    np.testing.assert_array_equal(AHEAD.project(behind, (9, 9))[:2], OUTSIDE)


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


def test_a_path_passes_through_its_keyframes() -> None:
    keys = [Camera((i * i, 1, 5), (0, i, 0), fov_y=40 + i) for i in range(4)]
    path = CameraPath.through(keys)
    for index, key in enumerate(keys):
        found = path.at(index / 3)
        np.testing.assert_allclose(found.position, key.position, atol=1e-9)
        np.testing.assert_allclose((*found.look_at, found.fov_y), (*key.look_at, key.fov_y), atol=1e-9)


def test_two_keyframes_make_a_straight_line_at_constant_speed() -> None:
    path = CameraPath.through([Camera((0, 0, 5), (0, 0, 0)), Camera((4, 0, 5), (0, 0, 0))])
    np.testing.assert_allclose([path.at(t).position[0] for t in (0.0, 0.25, 0.5, 1.0)], (0, 1, 2, 4), atol=1e-12)


def test_a_path_is_smooth_at_its_keyframes() -> None:
    path = CameraPath.through([Camera((x, 0, 5), (0, 0, 0)) for x in (0, 1, 4)])
    before, at, after = (path.at(0.5 + dt).position[0] for dt in (-1e-4, 0.0, 1e-4))
    assert after - at == pytest.approx(at - before, rel=1e-3)


def test_a_static_path_stays() -> None:
    assert CameraPath.static(AHEAD).at(0.7) is AHEAD


def test_an_empty_path_is_refused() -> None:
    with pytest.raises(SceneError, match="at least one camera"):
        CameraPath(())
