"""The room that stands in for a renderer keeps every promise a renderer makes: its G-buffer is exact."""

from __future__ import annotations

import numpy as np
import pytest

from svgf_cl.io.synthetic import FOCAL_LENGTH, HALF_SIZE, PERIOD, eye, room_frames

SHAPE = (45, 80)


def seen_points(index: int, depth: np.ndarray, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """World points (..., 3) that frame `index` sees at pixels x, y: the camera's formula, not the room's own code."""
    height, width = SHAPE
    right, down = ((p - (n - 1) / 2) / (FOCAL_LENGTH * height) for p, n in ((x, width), (y, height)))
    return eye(index) + depth[..., None] * np.stack([right, -down, -np.ones_like(x)], axis=-1)


@pytest.mark.parametrize("index", [1, 2, 5, 7])
def test_motion_and_depth_lead_to_the_same_point_a_frame_ago(index: int) -> None:
    frame = list(room_frames(SHAPE, index + 1))[index]
    y, x = np.indices(SHAPE, float)
    here = seen_points(index, frame.depth, x, y)
    before = seen_points(
        index - 1, frame.depth + frame.motion[..., 2], x + frame.motion[..., 0], y + frame.motion[..., 1]
    )
    np.testing.assert_allclose(before, here, atol=1e-5)
    assert np.abs(frame.motion).max(axis=(0, 1)).min() > 1e-3, "the camera moves along every axis"


def test_points_lie_on_the_wall_that_id_and_normal_tell() -> None:
    (frame,) = room_frames(SHAPE, 1)
    y, x = np.indices(SHAPE, float)
    points = seen_points(0, frame.depth, x, y)
    np.testing.assert_allclose((-frame.normal * points).sum(axis=-1), np.abs(frame.normal) @ HALF_SIZE, atol=1e-5)
    walls = {tuple(normal) for normal in frame.normal.reshape(-1, 3)}
    assert len(walls) == len(np.unique(frame.id)) == 5
    assert all(len(np.unique(frame.id[(frame.normal == wall).all(axis=-1)])) == 1 for wall in walls)


def test_the_g_buffer_is_periodic_and_the_noise_is_not() -> None:
    frames = list(room_frames((9, 16), PERIOD + 1))
    for name in ("albedo", "normal", "depth", "motion", "id"):
        np.testing.assert_allclose(getattr(frames[PERIOD], name), getattr(frames[0], name), atol=1e-5)
    assert not np.array_equal(frames[PERIOD].color, frames[0].color)


def test_the_split_adds_up() -> None:
    (frame,) = room_frames((9, 16), 1, signals=2)
    np.testing.assert_allclose(frame.direct + frame.indirect, frame.color, rtol=1e-6)
    assert not np.array_equal(frame.direct, frame.indirect)
    (single,) = room_frames((9, 16), 1)
    assert single.direct is single.indirect is None


def test_noise_follows_from_the_seed() -> None:
    one, same, other = (next(room_frames((9, 16), 1, seed=seed)).color for seed in (0, 0, 1))
    np.testing.assert_array_equal(one, same)
    assert not np.array_equal(one, other)


def test_the_mean_of_the_light_is_half_the_albedo() -> None:
    (frame,) = room_frames((180, 320), 1)
    assert frame.color.mean() == pytest.approx(0.5 * frame.albedo.mean(), rel=0.02)
