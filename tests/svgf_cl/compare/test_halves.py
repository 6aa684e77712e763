"""What is measured against two noisy halves is what it is against the truth."""

from __future__ import annotations

import math

import numpy as np
import pytest

from svgf_cl.compare import halves
from svgf_cl.compare.metrics import decibels, psnr

SIZE = (100, 100, 3)
TRUTH = np.random.default_rng(1).random(SIZE)
LEFT = np.repeat(np.arange(100)[None] < 50, 100, axis=0)


def noisy(seed: int, truth: np.ndarray = TRUTH, sigma: float = 0.1) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    return truth + rng.normal(0, sigma, truth.shape), truth + rng.normal(0, sigma, truth.shape)


def test_a_picture_better_than_the_truth_is_judged_rightly() -> None:
    found = decibels(halves.squared_error(TRUTH + 0.02, noisy(2)).value)
    assert found == pytest.approx(-20 * math.log10(0.02), abs=0.7)
    # Plainly against the mean of the halves the picture would seem ten decibels worse.
    assert psnr(TRUTH + 0.02, sum(noisy(2)) / 2) < found - 8


def test_a_perfect_picture_has_no_error_but_chance() -> None:
    assert abs(halves.squared_error(TRUTH, noisy(3)).value) < 3 * 0.1**2 / math.sqrt(TRUTH.size)
    assert decibels(0.0) == decibels(-1e-9) == math.inf


def test_only_the_pixels_asked_for_count() -> None:
    picture = TRUTH + np.where(LEFT, 0.25, 1.0)[..., None]
    assert halves.squared_error(picture, (TRUTH, TRUTH), LEFT).value == pytest.approx(0.25**2)
    assert math.isnan(halves.squared_error(picture, (TRUTH, TRUTH), LEFT & ~LEFT).value)


def test_nan_is_never_a_good_score() -> None:
    broken = np.where(LEFT[..., None], np.nan, TRUTH)
    assert math.isnan(decibels(halves.squared_error(broken, (TRUTH, TRUTH)).value))


def test_noise_of_the_truth_is_no_change_and_an_error_that_stays_is_none() -> None:
    earlier, later = noisy(4), noisy(5, TRUTH + 0.3)
    still = halves.squared_change(TRUTH + 0.2, TRUTH + 0.5, earlier, later).value
    assert abs(still) < 1e-3
    moved = halves.squared_change(TRUTH, TRUTH + 0.35, earlier, later).value
    assert moved == pytest.approx(0.05**2, abs=1e-3)


def test_light_too_much_is_told_whatever_the_noise() -> None:
    found = halves.brightness(1.04 * TRUTH, noisy(6, sigma=1.0), np.ones(SIZE[:2], np.bool_))
    assert found.value - 1 == pytest.approx(0.04, abs=0.02)
    half = halves.brightness(np.where(LEFT[..., None], 0.5 * TRUTH, TRUTH), (TRUTH, TRUTH), LEFT)
    assert half.value == pytest.approx(0.5)
