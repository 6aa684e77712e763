from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from svgf_cl_tracer.compiled import compiled
from svgf_cl_tracer.render import FRAME, REFERENCE
from svgf_cl_tracer.sampling import JITTER_PERIOD, halton, on_circle, pixel_jitter, random4, stream_key

COUNT = 1 << 16
ARGUMENTS = ("key", "pixel", "sample", "draw")
# Neighbouring streams of random numbers: as many as are compared with each other in one picture.
STREAMS = [(FRAME, 0, 0), (REFERENCE, 0, 0), (FRAME, 1, 0), (FRAME, 0, 1), (REFERENCE, 1, 0), (REFERENCE, 0, 1)]


@compiled
def fill(arguments: NDArray[np.int64], out: NDArray[np.float64]) -> None:
    for n in range(len(arguments)):
        out[n, 0], out[n, 1], out[n, 2], out[n, 3] = random4(
            arguments[n, 0], arguments[n, 1], arguments[n, 2], arguments[n, 3]
        )


def draw(**varied: int | NDArray[np.int64]) -> NDArray[np.float64]:
    """Draws (COUNT, 4) over varied arguments; the others are 3."""
    arguments = np.full((COUNT, 4), 3)
    for name, values in varied.items():
        arguments[:, ARGUMENTS.index(name)] = values
    result = np.empty((COUNT, 4))
    fill(arguments, result)
    return result


def assert_uniform(values: NDArray[np.float64], cells: int) -> None:
    """That points (N, D) in the unit cube fill its cells evenly: the chi-squared sum is that of its degrees."""
    counts, _ = np.histogramdd(values, bins=cells, range=[(0.0, 1.0)] * values.shape[1])
    expected = len(values) / counts.size
    freedom = counts.size - 1
    surprise = (((counts - expected) ** 2 / expected).sum() - freedom) / np.sqrt(2.0 * freedom)
    assert abs(surprise) < 5.0


def test_halton_starts_as_in_the_books() -> None:
    np.testing.assert_allclose([halton(i, 2) for i in (1, 2, 3, 4)], (1 / 2, 1 / 4, 3 / 4, 1 / 8))
    np.testing.assert_allclose([halton(i, 3) for i in (1, 2, 3, 4)], (1 / 3, 2 / 3, 1 / 9, 4 / 9))


def test_jitter_repeats_after_16_frames_and_not_before() -> None:
    offsets = [pixel_jitter(frame) for frame in range(3 * JITTER_PERIOD)]
    assert JITTER_PERIOD == 16
    assert len(set(offsets)) == 16
    assert offsets[:16] == offsets[16:32] == offsets[32:]
    assert np.abs(offsets).max() < 0.5


def test_random4_is_the_published_function() -> None:
    """pcg4d of Jarzynski and Olano, in 32-bit unsigned arithmetic."""

    def pcg4d(v: NDArray[np.uint32]) -> NDArray[np.uint32]:
        v = v * np.uint32(1664525) + np.uint32(1013904223)
        for turn in range(2):
            for target, a, b in ((0, 1, 3), (1, 2, 0), (2, 0, 1), (3, 1, 2)):
                v[target] += v[a] * v[b]
            if turn == 0:
                v ^= v >> np.uint32(16)
        return v

    with np.errstate(over="ignore"):
        for key, pixel, sample, number in ((0, 0, 0, 0), (7, 123456, 99, 5), (2**32 - 1, 2**31, 2**20, 1)):
            expected = pcg4d(np.array([pixel, sample, number, key], np.uint32)) / 2.0**32
            np.testing.assert_array_equal(random4(key, pixel, sample, number), expected)


@pytest.mark.parametrize("argument", ARGUMENTS)
def test_numbers_are_uniform_and_independent_along_each_argument(argument: str) -> None:
    u = draw(**{argument: np.arange(COUNT)})
    assert u.min() >= 0.0
    assert u.max() < 1.0
    for number in range(4):
        assert_uniform(u[:, [number]], 1024)
        for other in range(number):
            assert_uniform(u[:, [number, other]], 32)
    for step in (1, 2, 3, 64, 1280):
        for number in range(4):
            for other in range(4):
                assert_uniform(np.stack([u[:-step, number], u[step:, other]], axis=1), 32)


def test_numbers_are_uniform_over_pixels_and_samples_together() -> None:
    places = np.arange(COUNT)
    u = draw(key=stream_key(0, 0, 0), pixel=places % 256, sample=places // 256)
    assert_uniform(u, 8)
    # The mean over a row or a column has the spread of a mean of independent numbers.
    for axis in (0, 1):
        spread = u.reshape(256, 256, 4).mean(axis).std(0) * np.sqrt(256 * 12)
        np.testing.assert_allclose(spread, 1.0, atol=5 / np.sqrt(2 * 256))


def test_streams_are_not_correlated() -> None:
    streams = np.concatenate([draw(key=stream_key(*numbers), pixel=np.arange(COUNT)) for numbers in STREAMS], axis=1)
    correlation = np.corrcoef(streams.T) - np.eye(streams.shape[1])
    assert np.abs(correlation).max() < 5.0 / np.sqrt(COUNT)
    for first in range(0, streams.shape[1], 4):
        for second in range(first):
            assert_uniform(streams[:, [first, second]], 32)


def test_keys_differ_by_each_of_their_numbers_and_by_their_order() -> None:
    named = [(a, b, c) for a in range(2) for b in range(20) for c in range(200)]
    assert len({stream_key(*numbers) for numbers in named}) == len(named)
    assert stream_key(1, 2) == stream_key(1, 2)
    assert all(0 <= stream_key(*numbers) < 2**32 for numbers in named)


@settings(deadline=None)  # the first call compiles
@given(st.floats(0.0, 1.0, exclude_max=True))
def test_a_point_on_the_circle_is_that_of_the_library(u: float) -> None:
    np.testing.assert_allclose(on_circle(u), (math.cos(2 * math.pi * u), math.sin(2 * math.pi * u)), atol=2e-9)
