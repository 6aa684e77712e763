"""Properties of Kalman's oracle: what must hold whatever the kernels do (docs/algorithm.md)."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from svgf_cl import Kalman
from svgf_cl.oracle.kalman import CORRELATED, Oracle, believed, coarser_mean, innovation_mean, named, not_negative
from svgf_cl.oracle.taps import luminance
from tests.svgf_cl.oracle.scenes import SHAPE, bumpy, guides_of, wall

PLANE = (96, 96)


@pytest.fixture(scope="module")
def of_noise() -> dict[str, np.ndarray]:
    """The passes of the test over residuals that are white noise of variance 1, on a wall: 64 signals of it."""
    guides = guides_of(wall(PLANE))
    noise = np.random.default_rng(0).standard_normal((64, *PLANE))
    now = {"innovation": np.zeros((*noise.shape, 3)), "innovation_residual": noise}
    now |= innovation_mean(now, guides, Kalman())
    for number in (2, 3, 4):
        now |= named(f"change_{number}", *coarser_mean(now, number, Kalman()))
    return now


@pytest.mark.parametrize("number", CORRELATED)
def test_a_mean_of_white_noise_has_the_variance_that_is_claimed(of_noise: dict[str, np.ndarray], number: int) -> None:
    """Which the share of the recursion alone would be off by a factor of 2.5 at the widest pass."""
    inside = np.s_[..., 8:-8, 8:-8]
    variance = np.mean(of_noise[f"change_{number}_residual"][inside] ** 2)
    claimed = CORRELATED[number] * of_noise[f"change_{number}_share"][inside]
    assert_allclose(claimed, variance, rtol=0.05)


def test_nothing_is_believed_below_the_threshold_nearly_all_far_above_and_nothing_of_a_single_sample() -> None:
    share = np.array(0.01)
    deviation = np.sqrt(0.01) / 0.99
    assert believed(2.49 * deviation, np.array(1.0), share, 2.5) == 0
    assert_allclose(believed(5 * deviation, np.array(1.0), share, 2.5), 0.75)
    assert_allclose(believed(250 * deviation, np.array(1.0), share, 2.5), 1 - 1e-4)
    assert believed(np.array(1e6), np.array(1.0), np.array(1.0), 2.5) == 0


def test_light_stays_as_it_is_unless_a_channel_is_negative(rng: np.random.Generator) -> None:
    color = rng.random((5, 5, 3))
    assert_allclose(not_negative(color), color, rtol=1e-12)
    assert_array_equal(not_negative(-color), 0)
    assert_allclose(luminance(not_negative(color - (1, 0, 0))), luminance(color - (1, 0, 0)).clip(0), atol=1e-12)


def test_misses_neither_give_nor_take(rng: np.random.Generator) -> None:
    frames = [bumpy(rng, misses=0.3) for _ in range(3)]
    dull, glaring = Oracle(SHAPE, Kalman()), Oracle(SHAPE, Kalman())
    for frame in frames:
        miss = ~guides_of(frame).hit
        bright = wall(**frame.present() | {"color": np.where(miss[..., None], np.float32(1e6), frame.color)})
        expected, got = dull.denoise(frame), glaring.denoise(bright)
        assert_allclose(expected[miss], frame.color[miss], rtol=1e-6)
        assert_array_equal(got[~miss], expected[~miss])


def test_exposure_does_not_matter(rng: np.random.Generator) -> None:
    frames = [bumpy(rng) for _ in range(3)]
    once, scaled = Oracle(SHAPE, Kalman()), Oracle(SHAPE, Kalman())
    for frame in frames:
        expected = once.denoise(frame)
        got = scaled.denoise(wall(**frame.present() | {"color": 256 * frame.color}))
        assert_allclose(got, 256 * expected, rtol=1e-7)


def test_a_step_of_light_is_followed_at_once() -> None:
    oracle = Oracle(SHAPE, Kalman())
    for light in (0.5,) * 6 + (2.0,):
        picture = oracle.denoise(wall(color=light))
    assert_allclose(picture, 2.0, rtol=1e-2)
