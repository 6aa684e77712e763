"""Noise in depth is told from the planes that it is on."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from svgf_cl import Frame
from svgf_cl.check.noise import has_noisy_depth
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
