"""Noise in depth is told from the planes that it is on."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from svgf_cl import Frame
from svgf_cl.check.noise import has_noisy_depth, lacks_motion
from svgf_cl.io.synthetic import room_frame

SHAPE = (90, 160)


@pytest.fixture(scope="module")
def room() -> Frame:
    return room_frame(SHAPE, 1, 0)


def test_exact_depth_is_not_noisy(room: Frame) -> None:
    assert not has_noisy_depth(room)
    assert not has_noisy_depth(replace(room, depth=1e4 * room.depth))


@pytest.mark.parametrize("size", [3e-3, 0.05])
def test_jittered_depth_is_noisy(size: float, room: Frame) -> None:
    scale = np.random.default_rng(1).uniform(1 - size, 1 + size, SHAPE).astype(np.float32)
    assert has_noisy_depth(replace(room, depth=room.depth * scale))


def test_rays_that_fog_scattered_leave_holes(room: Frame) -> None:
    is_hole = np.random.default_rng(2).random(SHAPE) < 0.3
    normal = np.where(is_hole[..., None], 0.0, room.normal).astype(np.float32)
    assert has_noisy_depth(replace(room, normal=normal, depth=np.where(is_hole, np.inf, room.depth)))


def test_a_sky_and_frames_that_are_too_small_are_not_noisy(room: Frame) -> None:
    assert not has_noisy_depth(replace(room, normal=np.zeros_like(room.normal)))
    assert not has_noisy_depth(room_frame((1, 1), 1, 0))
    assert not has_noisy_depth(room_frame((2, 2), 1, 0))


def paved(room: Frame, number: int) -> Frame:
    """A frame whose motion is 0, though its tiles of 6 pixels moved by 4 a frame."""
    tiles = np.random.default_rng(4).uniform(0.1, 1.0, (SHAPE[0] // 6, SHAPE[1] // 6 + 1, 3))
    albedo = np.roll(np.repeat(np.repeat(tiles, 6, 0), 6, 1)[:, : SHAPE[1]], 4 * number, axis=1).astype(np.float32)
    return replace(room, albedo=albedo, motion=np.zeros_like(room.motion))


def test_motion_that_is_lost_is_told_from_a_still_shot(room: Frame) -> None:
    before, now = paved(room, 0), paved(room, 1)
    assert lacks_motion(now, before)
    assert not lacks_motion(replace(now, motion=room.motion - 4), before)
    assert not lacks_motion(before, before)
    normals = [replace(frame, albedo=None, normal=2 * frame.albedo - 1) for frame in (now, before)]
    assert lacks_motion(*normals)
    noise = np.random.default_rng(3).uniform(0.5, 1.0, (2, *SHAPE, 3)).astype(np.float32)
    still = [replace(before, albedo=each * before.albedo) for each in noise]
    assert not lacks_motion(*still), "noise alone is no motion"
