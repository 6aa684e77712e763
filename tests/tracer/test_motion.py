from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation, Slerp

from svgf_cl_tracer.errors import SceneError
from svgf_cl_tracer.motion import Keyframes, Motion, Track, rotation_matrix

RAMP = Track([1.0, 2.0, 4.0], [[0.0, 10.0], [2.0, 10.0], [-2.0, 30.0]])

times = st.floats(-2.0, 9.0)
quaternions = st.tuples(*[st.floats(-1, 1)] * 4).filter(lambda q: np.linalg.norm(q) > 0.1)


def test_a_track_moves_straight_from_keyframe_to_keyframe() -> None:
    np.testing.assert_allclose([RAMP.at(t) for t in (1.0, 1.5, 2.0, 3.5)], [(0, 10), (1, 10), (2, 10), (-1, 25)])


def test_a_track_stays_before_its_first_and_after_its_last_keyframe() -> None:
    np.testing.assert_array_equal(
        [RAMP.at(t) for t in (-5.0, 0.999, 4.0, 99.0)], [(0, 10), (0, 10), (-2, 30), (-2, 30)]
    )


def test_a_step_holds_each_value_until_the_next() -> None:
    switch = Track([0.0, 1.0, 2.0], [[5.0], [7.0], [0.0]], step=True)
    np.testing.assert_array_equal([switch.at(t)[0] for t in (-1, 0, 0.99, 1, 1.99, 2, 3)], (5, 5, 5, 7, 7, 0, 0))


@given(times)
def test_a_track_that_repeats_has_its_period(time: float) -> None:
    track = Track([1.0, 2.0, 4.0], [[0.0], [2.0], [0.0]], repeats=True)
    assert track.at(time)[0] == pytest.approx(track.at(time + 3.0)[0], abs=1e-9)
    inside = 1.0 + (time - 1.0) % 3.0
    assert track.at(time)[0] == pytest.approx(np.interp(inside, (1, 2, 4), (0, 2, 0)), abs=1e-9)


def test_a_single_keyframe_is_a_constant() -> None:
    for repeats in (False, True):
        assert Track([3.0], [[8.0]], repeats=repeats).at(-7.0) == [8.0]


@given(quaternions, quaternions, st.floats(0, 1))
def test_rotations_are_interpolated_along_the_shorter_arc(a: tuple, b: tuple, time: float) -> None:
    ends = Rotation.from_quat([a, b])
    if (ends[0].inv() * ends[1]).magnitude() > 3.14:
        return  # both ways round are as short
    track = Track([0.0, 1.0], ends.as_quat())
    np.testing.assert_allclose(
        rotation_matrix(track.rotation_at(time)), Slerp([0, 1], ends)(time).as_matrix(), atol=1e-6
    )


@given(quaternions)
def test_a_quaternion_is_the_rotation_it_names(quaternion: tuple) -> None:
    unit = np.divide(quaternion, np.linalg.norm(quaternion))
    np.testing.assert_allclose(rotation_matrix(unit), Rotation.from_quat(unit).as_matrix(), atol=1e-12)


def test_keyframes_scale_then_turn_then_move() -> None:
    quarter = Rotation.from_euler("z", 90, degrees=True).as_quat()
    frame = Keyframes(Track([0.0], [[1.0, 2.0, 3.0]]), Track([0.0], [quarter]), Track([0.0], [[2.0, 3.0, 4.0]]))
    np.testing.assert_allclose(frame.matrix(0.0) @ (1, 1, 1, 1), (1 - 3, 2 + 2, 3 + 4, 1))
    np.testing.assert_array_equal(Keyframes().matrix(5.0), np.eye(4))


def test_the_outermost_parent_acts_last() -> None:
    quarter = Track([0.0], [Rotation.from_euler("z", 90, degrees=True).as_quat()])
    shift = np.eye(4)
    shift[:3, 3] = (5, 0, 0)
    np.testing.assert_allclose(Motion([shift, Keyframes(rotation=quarter)]).matrix(0.0)[:3, 3], (5, 0, 0))
    np.testing.assert_allclose(Motion([Keyframes(rotation=quarter), shift]).matrix(0.0)[:3, 3], (0, 5, 0), atol=1e-12)


def test_a_motion_changes_where_its_values_do() -> None:
    """Exporters write keyframes for what stands still too."""
    still = Track([0.0, 3.0], [(1, 2, 3), (1, 2, 3)])
    moving = Track([-1.0, 5.0, 6.0], [(1, 2, 3), (1, 2, 3), (0, 0, 0)])
    for motion, span in (
        (Motion([np.eye(4), Keyframes(translation=still, scale=still)]), (0, 0)),
        (Motion([np.eye(4), Keyframes(translation=still, scale=moving)]), (-1, 6)),
        (Motion([Keyframes(moving), Keyframes(Track([7.0, 8.0], [(0, 0, 0), (1, 0, 0)]))]), (-1, 8)),
    ):
        assert motion.span == span
        assert motion.changes == (span != (0, 0))


@given(times, st.sampled_from([(2.0, 3.0, 4.0), (0.0, 0.0, 0.0), (0.0, 1.0, 1e-9)]))
def test_sizes_turn_no_direction(time: float, size: tuple[float, float, float]) -> None:
    turn = Motion.turning((1, 2, 3), (1, 1, 0), [0.0, 4.0], [0.0, 170.0])
    sizes = Track([0.0, 4.0], [size, (1.0, 1.0, 1.0)])
    motion = Motion([np.diag([5.0, 5.0, 5.0, 1.0]), Keyframes(scale=sizes), *turn.links, Keyframes(scale=sizes)])
    linear = turn.matrix(time)[:3, :3]
    np.testing.assert_allclose(motion.turn(time), linear, atol=1e-9)


def test_a_mirroring_size_turns_directions_back() -> None:
    np.testing.assert_array_equal(Motion([np.diag([1.0, 1.0, -3.0, 1.0])]).turn(0.0), np.diag([1, 1, -1]))


def test_positions_are_relative_to_an_origin() -> None:
    motion = Motion.sliding([0.0, 2.0], [(1e9, 0, 0), (1e9 + 1, 0, 0)]).relative_to((1e9, 2.0, 0.0))
    np.testing.assert_array_equal(motion.matrix(1.0) @ (0, 0, 0, 1), (0.5, -2, 0, 1))


def test_sliding_passes_through_its_positions() -> None:
    motion = Motion.sliding([0.0, 2.0], [(0, 0, 0), (4, 0, -2)])
    np.testing.assert_allclose(motion.matrix(0.5) @ (1, 1, 1, 1), (2, 1, 0.5, 1))
    swinging = Motion.sliding([0.0, 1.0, 2.0], [(0, 0, 0), (4, 0, 0), (0, 0, 0)], repeats=True)
    np.testing.assert_allclose(swinging.matrix(7.5)[:3, 3], (2, 0, 0))


@given(times)
def test_turning_is_about_the_axis_through_the_pivot(time: float) -> None:
    pivot, axis = np.array((1.0, 2.0, 3.0)), np.array((0.0, 3.0, 4.0))
    motion = Motion.turning(pivot, axis, [0.0, 1.0, 4.0], [0.0, 170.0, 20.0])
    degrees = np.interp(time, (0, 1, 4), (0, 170, 20))
    expected = Rotation.from_rotvec(axis / 5.0 * math.radians(degrees)).as_matrix()
    np.testing.assert_allclose(motion.matrix(time)[:3, :3], expected, atol=1e-9)
    np.testing.assert_allclose(motion.matrix(time) @ (*(pivot + 2 * axis), 1.0), (*(pivot + 2 * axis), 1.0), atol=1e-9)


@pytest.mark.parametrize(
    ("moments", "values", "named"),
    [
        ([], np.zeros((0, 3)), r"\(0,\) and \(0, 3\)"),
        ([0.0, 1.0], [[1.0]], r"\(2,\) and \(1, 1\)"),
        ([0.0], [1.0], r"\(1,\) and \(1,\)"),
        ([1.0, 1.0], [[0.0], [1.0]], "ascending"),
        ([2.0, 1.0], [[0.0], [1.0]], "ascending"),
        ([0.0, np.nan], [[0.0], [1.0]], "finite"),
        ([0.0, 1.0], [[0.0], [np.inf]], "finite"),
    ],
)
def test_keyframes_that_make_no_track_are_refused(moments: list, values: list, named: str) -> None:
    with pytest.raises(SceneError, match=f"keyframes: .*{named}"):
        Track(moments, values)


def test_an_axis_or_a_quaternion_of_length_0_is_refused() -> None:
    with pytest.raises(SceneError, match="length above 0"):
        Motion.turning((0, 0, 0), (0, 0, 0), [0.0], [1.0])
    with pytest.raises(SceneError, match="length above 0"):
        Keyframes(rotation=Track([0.0], [[0.0, 0.0, 0.0, 0.0]])).matrix(0.0)
