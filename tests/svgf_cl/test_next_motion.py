"""Motion to the next frame is the truth where the next frame shows the surface, and NaN where it does not."""

from __future__ import annotations

from dataclasses import replace
from math import cos, radians, sin

import numpy as np
import pyopencl as cl
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from svgf_cl import Frame, FrameError, motion_to_next
from svgf_cl.io.synthetic import room_frame
from tests.frames import FULL, PLAIN, SHAPE, bumpy_sequence, only, wall
from tests.svgf_cl.device.test_user_arrays import on_device

DOWN, ACROSS = np.indices(SHAPE).astype(float)
PLACES = np.stack((ACROSS, DOWN), axis=-1)
CENTRE = np.array((SHAPE[1] - 1, SHAPE[0] - 1)) / 2


def lost(motion: np.ndarray) -> np.ndarray:
    """Where there is none, (H, W)."""
    return np.isnan(motion).any(axis=-1)


def inside(place: np.ndarray, margin: float = 0.0) -> np.ndarray:
    """Where places (H, W, 2) lie in the picture, (H, W)."""
    return ((place >= margin) & (place <= 2 * CENTRE - margin)).all(axis=-1)


@pytest.mark.parametrize("index", range(8))
def test_it_is_exact_for_a_camera_that_moves_in_a_room(index: int) -> None:
    """The room can tell: a frame that comes after its own successor has that motion."""
    shape = (90, 160)
    motion = motion_to_next(room_frame(shape, index, index - 1), room_frame(shape, index + 1, index))
    truth = room_frame(shape, index, index + 1).motion
    seen = ~lost(motion)
    assert_allclose(motion[seen], truth[seen], atol=0.03)  # at the border it may be that of the pixel beside
    assert np.abs(motion - truth)[seen].mean() < 5e-4
    assert np.mean(seen) > 0.97
    assert np.mean(seen[2:-2, 2:-2]) > 0.998, "what is lost lies at the picture's border"


@given(x=st.floats(-9, 9), y=st.floats(-9, 9), deeper=st.floats(-1, 1))
def test_a_shift_is_turned_round(x: float, y: float, deeper: float) -> None:
    motion = motion_to_next(wall(depth=4 + deeper), wall(motion=(x, y, deeper)))
    assert_allclose(
        motion[~lost(motion)], np.broadcast_to((-x, -y, -deeper), motion.shape)[~lost(motion)], rtol=1e-5, atol=1e-12
    )
    away = PLACES - (x, y)
    assert not lost(motion)[inside(away)].any()
    assert lost(motion)[~inside(away, -1)].all()


@given(scale=st.floats(0.7, 1.4), degrees=st.floats(-20, 20), x=st.floats(-3, 3), y=st.floats(-3, 3))
def test_zoom_and_rotation_leave_no_cracks(scale: float, degrees: float, x: float, y: float) -> None:
    """The place p of the next frame was scale R (p - centre) + centre + (x, y)."""
    turn = scale * np.array(
        [[cos(radians(degrees)), -sin(radians(degrees))], [sin(radians(degrees)), cos(radians(degrees))]]
    )
    before = (PLACES - CENTRE) @ turn.T + CENTRE + (x, y)
    following = replace(wall(), motion=(before - PLACES).astype(np.float32))
    after = (PLACES - CENTRE - (x, y)) @ np.linalg.inv(turn).T + CENTRE
    motion = motion_to_next(wall(), following)
    known = inside(after, 1)
    assert not lost(motion)[known].any()
    change = np.abs(np.linalg.inv(turn) - np.eye(2)).sum(axis=1).max()  # of motion, from a pixel to the next
    assert np.abs(motion - (after - PLACES))[known].max(initial=0) <= 0.5 * change + 1e-4


def two_layers(at: int, **fields: object) -> Frame:
    """A square of 12 pixels, twice as near as the wall behind it, whose left edge is in column `at`."""
    square = (at <= ACROSS) & (at + 12 > ACROSS) & (DOWN >= 10) & (DOWN < 22)
    return wall(depth=np.where(square, 2.0, 4.0), **fields)


@pytest.mark.parametrize("with_id", [False, True])
def test_what_a_nearer_thing_hides_has_no_motion(with_id: bool) -> None:
    shift = 5
    square = two_layers(8).depth < 3
    now, then = (two_layers(at, id=1 + np.where(two_layers(at).depth < 3, 1, 0)) for at in (8, 8 + shift))
    moving = np.where((then.depth < 3)[..., None], (-shift, 0, 0), (0, 0, 0)).astype(np.float32)
    following = replace(then, motion=moving)
    if not with_id:
        now, following = (only(each, PLAIN) for each in (now, following))
    motion = motion_to_next(now, following)
    hidden = ~square & (then.depth < 3)
    assert hidden.sum() == 12 * shift
    assert_array_equal(lost(motion), hidden)
    assert_array_equal(motion[square], np.broadcast_to((shift, 0, 0), motion[square].shape))
    assert_array_equal(motion[~square & ~hidden], 0)


def test_ids_tell_things_of_one_depth_apart() -> None:
    left = SHAPE[1] // 2 > ACROSS
    now = wall(id=1 + left)
    shift = np.where(left[..., None], (2.0, 0, 0), 0.0)  # the left half moves out of the picture
    motion = motion_to_next(now, replace(now, motion=shift.astype(np.float32)))
    assert_array_equal(motion[~left], 0)
    assert_array_equal(motion[left & ~lost(motion)][:, 0], -2)


def test_the_sky_has_motion_and_hides_nothing() -> None:
    bar = (ACROSS >= 10) & (ACROSS < 13)
    now = wall(depth=np.where(bar, 4.0, np.inf), normal=bar[..., None] * np.array((0, 0, 1.0)))
    motion = motion_to_next(now, replace(now, motion=wall(motion=(0.5, 0, 0)).motion))
    assert not lost(motion).any()
    assert_array_equal(motion, np.broadcast_to(np.float32((-0.5, 0, 0)), motion.shape))


@pytest.mark.parametrize("fields", [PLAIN, FULL])
@pytest.mark.parametrize("channels", [2, 3])
def test_garbage_leaves_no_trace_but_where_it_is(fields: tuple[str, ...], channels: int) -> None:
    """Each value that is not finite takes its own pixel away, and no other."""
    now, following = bumpy_sequence(fields, count=2, motion=channels)
    rng = np.random.default_rng(0)
    bad = rng.random(SHAPE) < 0.2
    broken = following.motion.copy()
    broken[bad, rng.integers(channels, size=bad.sum())] = rng.choice((np.nan, np.inf, -np.inf), bad.sum())
    out = following.motion.copy()
    out[bad] = 1e6
    assert_array_equal(
        motion_to_next(now, replace(following, motion=broken)), motion_to_next(now, replace(following, motion=out))
    )


def test_motion_of_two_components_gives_two() -> None:
    motion = motion_to_next(wall(), replace(wall(), motion=np.zeros((*SHAPE, 2), np.float32)))
    assert (motion.shape, motion.dtype) == ((*SHAPE, 2), np.float32)
    assert motion.flags.c_contiguous


@pytest.mark.parametrize("shape", [(1, 1), (1, 7), (5, 1)])
def test_small_pictures(shape: tuple[int, int]) -> None:
    assert_array_equal(motion_to_next(wall(shape), wall(shape)), 0)


def test_frames_must_fit_together_and_be_on_the_host(queue: cl.CommandQueue) -> None:
    with pytest.raises(FrameError, match=r"expected shape"):
        motion_to_next(wall((7, 9)), wall((9, 7)))
    (frame,) = bumpy_sequence(PLAIN, count=1)
    with pytest.raises(FrameError, match=r"Frame\.\w+: expected a numpy\.ndarray"):
        motion_to_next(frame, on_device(frame, queue))
