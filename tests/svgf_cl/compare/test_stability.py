"""Pictures change as much as they should, more, or less."""

from __future__ import annotations

import math

import numpy as np
import pytest

from svgf_cl.compare.reprojection import Reprojection
from svgf_cl.compare.share import Share
from svgf_cl.compare.stability import Covariance, Flicker, excess, residual, root
from tests.frames import wall

SHAPE = (40, 50)
EVERYWHERE = np.ones(SHAPE, np.bool_)
TRUTH = 0.3 + 0.4 * np.random.default_rng(0).random((*SHAPE, 3))
FRAMES = 12
SIGMA = 0.02


def noisy(seed: int, sigma: float = SIGMA, truth: np.ndarray = TRUTH) -> np.ndarray:
    """A series of pictures of what rests."""
    return truth + np.random.default_rng(seed).normal(0, sigma, (FRAMES, *SHAPE, 3))


def flicker(pictures: np.ndarray, first: np.ndarray, second: np.ndarray, resting: np.ndarray = EVERYWHERE) -> float:
    found = Flicker()
    for picture, *halves in zip(pictures, first, second, strict=True):
        found.see(picture, (halves[0], halves[1]), resting)
    return found.value


def test_covariance_is_that_of_samples() -> None:
    first, second = noisy(1), noisy(2) * noisy(1)
    series = Covariance()
    for pair in zip(first, second, strict=True):
        series.add(*pair)
    assert series.value[3, 4, 1] == pytest.approx(np.cov(first[:, 3, 4, 1], second[:, 3, 4, 1])[0, 1], rel=1e-4)


def test_a_picture_flickers_by_its_noise_whatever_the_truths() -> None:
    exact = noisy(0, sigma=0)
    assert flicker(exact, exact, exact) == 0
    assert flicker(noisy(1), exact, exact) == pytest.approx(SIGMA, rel=0.02)
    assert flicker(noisy(1), noisy(2, 0.005), noisy(3, 0.005)) == pytest.approx(SIGMA, abs=1e-3)


def test_light_that_changes_is_no_flicker_and_to_miss_it_is_less_than_none() -> None:
    waves = 0.1 * np.sin(np.arange(FRAMES))[:, None, None, None]
    deviation = np.std(waves, ddof=1)
    moved = TRUTH + waves
    assert flicker(moved, moved, moved) == pytest.approx(0, abs=1e-6)
    assert flicker(noisy(0, sigma=0), noisy(4) + waves, noisy(5) + waves) == pytest.approx(-deviation, rel=0.02)


def test_only_what_rests_in_all_frames_flickers() -> None:
    left = np.broadcast_to(np.arange(SHAPE[1]) < 25, SHAPE)
    pictures = np.where(left[..., None], TRUTH, noisy(1))
    exact = noisy(0, sigma=0)
    assert flicker(pictures, exact, exact, left) == 0
    found = Flicker()
    for number, picture in enumerate(pictures):
        found.see(picture, (TRUTH, TRUTH), left if number == 5 else EVERYWHERE)
    assert found.value == 0
    assert math.isnan(flicker(pictures, exact, exact, left & ~left))


PANNED = Reprojection.between(wall(SHAPE), wall(SHAPE, motion=(-2.0, 0.0)))
SHIFTED = np.roll(TRUTH, 2, axis=1)


def warped(earlier: np.ndarray, later: np.ndarray, sigma: float = 0.0) -> float:
    """The excess, of halves that are noisy."""
    before, now = noisy(6, sigma), noisy(7, sigma, SHIFTED)
    truth = residual((before[0], before[1]), (now[0], now[1]), PANNED)
    return excess(residual((earlier, earlier), (later, later), PANNED), truth)


def test_exact_motion_explains_what_moves() -> None:
    assert warped(TRUTH, SHIFTED) == pytest.approx(0, abs=1e-7)


def test_noise_of_pictures_is_not_explained_and_that_of_the_truth_does_not_count() -> None:
    seen = noisy(8)[0], noisy(9, truth=SHIFTED)[0]
    assert warped(*seen) == pytest.approx(math.sqrt(2) * SIGMA, rel=0.05)
    assert warped(*seen, sigma=0.005) == pytest.approx(math.sqrt(2) * SIGMA, abs=2e-3)


def test_a_picture_that_stands_still_does_not_follow() -> None:
    assert warped(TRUTH, TRUTH) > 0.1


def test_nothing_found_again_is_no_figure() -> None:
    elsewhere = Reprojection.between(wall(SHAPE), wall(SHAPE, motion=(1000.0, 0.0)))
    assert residual((TRUTH, TRUTH), (TRUTH, TRUTH), elsewhere) == Share(0, 0)
    assert math.isnan(excess(Share(), Share()))


def test_a_square_estimated_below_0_has_no_root() -> None:
    assert [root(0.25), root(-1e-9)] == [0.5, 0]
    assert math.isnan(root(math.nan))


@pytest.mark.filterwarnings("error")
def test_of_one_picture_nothing_is_known() -> None:
    found = Flicker()
    found.see(TRUTH, (TRUTH, TRUTH), EVERYWHERE)
    assert math.isnan(found.value)
