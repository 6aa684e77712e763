"""Estimates put together in any way are those of all samples at once, and their error is honest."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from svgf_cl.compare.metrics import relmse
from svgf_cl_tracer.estimate import Estimate

PIXELS = 6


def gathered(samples: np.ndarray) -> Estimate:
    """The estimate from samples (S, PIXELS, 5, 3), put together from two tiles."""
    return Estimate.beside(Estimate.of(samples[:, part]) for part in (slice(0, 4), slice(4, PIXELS)))


def light(count: int, seed: int = 0, *, offset: float = 0.0) -> np.ndarray:
    return (np.random.default_rng(seed).exponential(1.0, (count, PIXELS, 5, 3)) + offset).astype(np.float32)


@settings(deadline=None)  # the first example compiles
@given(sizes=st.lists(st.integers(2, 9), min_size=1, max_size=6), seed=st.integers(0, 99))
def test_parts_make_the_whole(sizes: list[int], seed: int) -> None:
    samples = light(sum(sizes), seed)
    estimate = Estimate.nothing(PIXELS)
    for part in np.split(samples, np.cumsum(sizes)[:-1]):
        estimate = estimate.merged(gathered(part))
    colors = samples.sum(2, np.float64)
    assert estimate.spp == len(samples)
    assert [step.spp for step in estimate.history] == np.cumsum(sizes).tolist()
    np.testing.assert_allclose(estimate.light, samples.mean(0, np.float64), rtol=1e-5)
    np.testing.assert_allclose(estimate.color, colors.mean(0), rtol=1e-5)
    expected = colors.std(0, ddof=1) / np.sqrt(len(samples))
    np.testing.assert_allclose(estimate.standard_error, expected, rtol=1e-3)
    assert len(estimate.errors) == len(sizes)
    assert estimate.error == estimate.errors[-1]


def test_the_spread_of_a_part_is_relative_to_the_mean_before_it() -> None:
    first, second, third = np.split(light(12), 3)
    estimate = Estimate.nothing(PIXELS)
    for part in (first, second, third):
        estimate = estimate.merged(gathered(part))

    def relative(part: np.ndarray, before: np.ndarray) -> float:
        shares = part.sum(2).var(0, ddof=1) / (before.sum(2).mean(0) ** 2 + 0.01)
        return float(shares.mean())

    told = relative(first, first), relative(second, first), relative(third, np.concatenate([first, second]))
    np.testing.assert_allclose([step.variance for step in estimate.history], told, rtol=1e-3)
    means = told[0], (told[0] + 16 * told[1]) / 17, (told[0] + 16 * told[1] + 64 * told[2]) / 81
    np.testing.assert_allclose(estimate.errors, np.sqrt(np.divide(means, (4, 8, 12))), rtol=1e-3)


def test_a_large_mean_hides_no_spread() -> None:
    samples = light(256, offset=1000.0)
    estimate = Estimate.nothing(PIXELS)
    for part in np.split(samples, 16):
        estimate = estimate.merged(gathered(part))
    expected = samples.sum(2, np.float64).std(0, ddof=1) / 16
    np.testing.assert_allclose(estimate.standard_error, expected, rtol=0.01)


def test_an_estimate_is_not_changed_by_what_is_made_of_it() -> None:
    estimate = gathered(light(4))
    before = estimate.light.copy()
    estimate.merged(gathered(light(4, seed=1)))
    np.testing.assert_array_equal(estimate.light, before)


@pytest.mark.parametrize("estimate", [Estimate.nothing(PIXELS), gathered(light(1))])
def test_one_sample_tells_nothing_of_the_error(estimate: Estimate) -> None:
    assert np.isposinf(estimate.standard_error).all()
    assert estimate.error == np.inf


@pytest.mark.parametrize("chance", [1.0, 0.2])
def test_the_square_of_the_error_is_the_expected_relmse(chance: float) -> None:
    """Also of light that few samples find; then the error is rather too large than too small."""
    truth = np.full((PIXELS, 3), 5.0 * 0.2)
    found, told = [], []
    for seed in range(200):
        samples = light(256, seed) * (0.2 / chance)
        samples *= np.random.default_rng(seed).random((256, PIXELS, 1, 1)) < chance
        estimate = Estimate.nothing(PIXELS)
        for part in np.split(samples, 16):
            estimate = estimate.merged(gathered(part))
        found.append(relmse(estimate.color, truth))
        told.append(estimate.error**2)
    assert 0.9 < np.mean(told) / np.mean(found) < (1.1 if chance == 1.0 else 1.5)
