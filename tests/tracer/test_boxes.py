"""A box may let rays through for nothing, but never keep one from what it holds."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from svgf_cl_tracer.boxes import EVERYWHERE, bounds, corners_of_box, passing
from svgf_cl_tracer.trees import FAR

# More than single precision moves the end of a ray by that is so long.
ROOM = 1e-2

UNIT = np.array([[0.0, 0.0, 0.0], [1.0, 1.0, 1.0]])

places = st.tuples(*[st.floats(-1e3, 1e3, width=32)] * 3)


def passes(box: np.ndarray, origin: object, direction: object, distance: float = float(FAR)) -> bool:
    rays = [np.array([row], np.float32) for row in (origin, direction)]
    return bool(passing([box], rays[0], rays[1], np.array([distance], np.float32))[0])


@settings(deadline=None)
@given(st.lists(places, min_size=1, max_size=4), places, st.integers(0, 3))
def test_a_ray_to_a_point_inside_passes(points: list, origin: tuple, number: int) -> None:
    target = np.array(points[number % len(points)])
    way = target - origin
    length = np.linalg.norm(way)
    if length < 1e-2:
        return
    box = bounds(np.array(points)) + np.array([[-ROOM], [ROOM]])
    assert passes(box, origin, way / length, length * (1.0 + 1e-5) + ROOM)


@pytest.mark.parametrize(
    ("origin", "direction", "expected"),
    [
        ((-1, 0.5, 0.5), (1, 0, 0), True),
        ((-1, 0.5, 0.5), (-1, 0, 0), False),
        ((-1, 1.5, 0.5), (1, 0, 0), False),
        ((0.5, 0.5, 0.5), (0, 0, 1), True),
        ((-1, 1.0, 0.5), (1, 0, 0), True),  # along a face
        ((-1, -1, -1), (0.6, 0.8, 0), False),
        ((-1, -1, 0.5), (0.6, 0.8, 0), True),
    ],
)
def test_rays_and_the_unit_box(origin: tuple, direction: tuple, expected: bool) -> None:
    assert passes(UNIT, origin, direction) == expected


def test_a_box_beyond_the_ray_is_not_passed() -> None:
    assert not passes(UNIT, (-3, 0.5, 0.5), (1, 0, 0), 2.9)
    assert passes(UNIT, (-3, 0.5, 0.5), (1, 0, 0), 3.1)


def test_any_of_several_boxes_counts_and_none_does_not() -> None:
    origin, direction = np.array([(-1, 0.5, 0.5), (-1, 5.5, 0.5)], np.float32), np.array([(1, 0, 0)] * 2, np.float32)
    far = np.full(2, FAR)
    np.testing.assert_array_equal(passing([UNIT, UNIT + 5.0], origin, direction, far), (True, False))
    np.testing.assert_array_equal(passing([UNIT + 5.0, UNIT], origin, direction, far), (True, False))
    assert not passing([], origin, direction, far).any()


@settings(deadline=None)
@given(places, st.sampled_from([(1, 0, 0), (0, -1, 0), (0, 0, 1), (0.6, 0.0, -0.8)]))
def test_everywhere_is_passed_by_all(origin: tuple, direction: tuple) -> None:
    assert passes(EVERYWHERE, origin, direction)


def test_corners_span_their_box() -> None:
    corners = corners_of_box(np.array([[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]))
    assert len(np.unique(corners, axis=0)) == 8
    np.testing.assert_array_equal(bounds(corners), [(1, 2, 3), (4, 5, 6)])


def test_a_ray_along_a_face_passes() -> None:
    box = np.array([[-1.0, -1.0, -1.0], [1.0, 0.0, 1.0]])
    assert passes(box, (-3, 1e-5, 0), (1, 0, 0))
    assert passes(box, (-3, 0, 0), (1, 0, 0))
