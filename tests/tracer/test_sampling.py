from __future__ import annotations

import numpy as np

from tracer.sampling import (
    JITTER_PERIOD,
    cosine_directions,
    halton,
    pixel_jitter,
    random_stream,
    sphere_directions,
    triangle_coordinates,
)

COUNT = 20_000


def uniform(rows: int) -> np.ndarray:
    return random_stream(1).random((rows, COUNT), dtype=np.float32)


def test_halton_starts_as_in_the_books() -> None:
    np.testing.assert_allclose([halton(i, 2) for i in (1, 2, 3, 4)], (1 / 2, 1 / 4, 3 / 4, 1 / 8))
    np.testing.assert_allclose([halton(i, 3) for i in (1, 2, 3, 4)], (1 / 3, 2 / 3, 1 / 9, 4 / 9))


def test_jitter_repeats_after_16_frames_and_not_before() -> None:
    offsets = [pixel_jitter(frame) for frame in range(3 * JITTER_PERIOD)]
    assert JITTER_PERIOD == 16
    assert len(set(offsets)) == 16
    assert offsets[:16] == offsets[16:32] == offsets[32:]
    assert np.abs(offsets).max() < 0.5


def test_streams_differ_by_every_part_of_their_key() -> None:
    first = random_stream(0, 1, 2).random(8)
    np.testing.assert_array_equal(first, random_stream(0, 1, 2).random(8))
    assert not np.array_equal(first, random_stream(0, 1, 3).random(8))
    assert not np.array_equal(first, random_stream(1, 1, 2).random(8))


def test_sphere_directions_are_unit_and_uniform() -> None:
    directions = sphere_directions(uniform(2))
    np.testing.assert_allclose(np.linalg.norm(directions, axis=0), 1, atol=1e-5)
    np.testing.assert_allclose(directions.mean(1), 0, atol=0.02)
    np.testing.assert_allclose(directions @ directions.T / COUNT, np.eye(3) / 3, atol=0.02)


def test_cosine_directions_have_the_moments_of_the_cosine() -> None:
    normal = np.tile(np.array([[0.6], [0.0], [0.8]], np.float32), COUNT)
    directions = cosine_directions(normal, uniform(2))
    cosine = (directions * normal).sum(0) / np.linalg.norm(directions, axis=0)
    assert cosine.min() >= -1e-3
    np.testing.assert_allclose([cosine.mean(), (cosine**2).mean()], (2 / 3, 1 / 2), atol=0.01)


def test_triangle_coordinates_are_uniform_over_the_triangle() -> None:
    b, c = triangle_coordinates(uniform(2))
    assert b.min() >= 0
    assert c.min() >= 0
    assert (b + c).max() <= 1 + 1e-6
    np.testing.assert_allclose(
        [b.mean(), c.mean(), (b * b).mean(), (b * c).mean()], (1 / 3, 1 / 3, 1 / 6, 1 / 12), atol=0.01
    )
