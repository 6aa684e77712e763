"""Contrast that is kept, lost, or only noise."""

from __future__ import annotations

import math

import numpy as np
import pytest

from svgf_cl.compare import kept

EDGE = np.repeat(np.arange(16)[None, :, None] >= 8, 16, axis=0) * np.ones(3)
EVERYWHERE = np.ones((16, 16), np.bool_)

LIT, SHADOW = 1.0, 0.2
SIZE = (120, 160)
FLOOR = np.where((np.arange(SIZE[1]) // 20) % 2, LIT, SHADOW) * np.ones((SIZE[0], 1))
INSIDE = np.pad(np.ones((SIZE[0] - 4, SIZE[1] - 4), np.bool_), 2)


def halves(sigma: float) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(7)
    return FLOOR + rng.normal(0, sigma, SIZE), FLOOR + rng.normal(0, sigma, SIZE)


def faded(share: float) -> np.ndarray:
    """The floor with that share of the difference between light and shadow."""
    return FLOOR.mean() + share * (FLOOR - FLOOR.mean())


def sharpness(shown: np.ndarray, where: np.ndarray = EVERYWHERE) -> float:
    return kept.sharpness(shown, (EDGE, EDGE), where).value


def test_a_copy_is_as_sharp_and_half_the_contrast_half_as_sharp() -> None:
    assert sharpness(EDGE) == pytest.approx(1)
    assert sharpness(0.5 * EDGE + 0.2) == pytest.approx(0.5)
    assert sharpness(np.full_like(EDGE, 0.5)) == 0


def test_edges_are_looked_for_where_they_are_asked_for() -> None:
    left = EVERYWHERE & (np.arange(16) < 4)
    assert math.isnan(sharpness(EDGE, left))
    assert math.isnan(sharpness(EDGE, np.zeros_like(left)))


def test_noise_of_picture_and_truth_is_no_sharpness() -> None:
    edge = np.repeat(np.arange(200)[None, :, None] >= 100, 200, axis=0) * np.ones(3)
    rng = np.random.default_rng(0)
    picture, first, second = (edge + rng.normal(0, sigma, edge.shape) for sigma in (0.5, 0.3, 0.3))
    everywhere = np.ones(edge.shape[:2], np.bool_)
    assert kept.sharpness(picture, (first, second), everywhere).value == pytest.approx(1, abs=0.1)
    assert kept.sharpness(0.3 * picture, (first, second), everywhere).value == pytest.approx(0.3, abs=0.05)


def test_the_gradient_is_that_of_luminance() -> None:
    y, x = np.indices((8, 9))
    ramp = (0.1 * x + 0.02 * y)[..., None] * np.ones(3)
    np.testing.assert_allclose(kept.gradient(ramp)[1:-1, 1:-1], np.broadcast_to((0.1, 0.02), (6, 7, 2)))


@pytest.mark.parametrize("exposure", [1e-3, 1.0, 1e3])
def test_light_as_it_is_has_all_contrast_at_any_exposure(exposure: float) -> None:
    assert kept.contrast(exposure * FLOOR, (FLOOR, FLOOR), INSIDE).value == pytest.approx(1)
    assert kept.contrast(np.full(SIZE, exposure), (FLOOR, FLOOR), INSIDE).value == pytest.approx(0, abs=1e-9)


def test_a_faded_shadow_keeps_its_share() -> None:
    faint = 1 + 0.3 * (FLOOR - FLOOR.mean())  # light is much the same in all windows
    assert kept.contrast(1 + 0.15 * (FLOOR - FLOOR.mean()), (faint, faint), INSIDE).value == pytest.approx(0.5, rel=0.1)
    shares = [kept.contrast(faded(share), (FLOOR, FLOOR), INSIDE).value for share in (-0.5, 0, 0.3, 0.7, 1)]
    assert shares == sorted(shares)
    assert shares[1] == pytest.approx(0, abs=1e-9)


@pytest.mark.parametrize("sigma", [0.02, 0.1])
def test_noise_of_picture_and_truth_is_no_contrast(sigma: float) -> None:
    exact = kept.contrast(faded(0.3), (FLOOR, FLOOR), INSIDE).value
    picture = faded(0.3) + np.random.default_rng(8).normal(0, 0.1, SIZE)
    assert kept.contrast(picture, halves(sigma), INSIDE).value == pytest.approx(exact, abs=0.05)


def test_light_that_stayed_from_brighter_days_is_no_contrast() -> None:
    assert kept.contrast(FLOOR + 50, (FLOOR, FLOOR), INSIDE).value < 0.02


def test_contrast_that_is_nearly_none_is_no_figure() -> None:
    rng = np.random.default_rng(10)
    flat = tuple(1 + rng.normal(0, 0.2, SIZE) for _ in range(2))
    assert math.isnan(kept.contrast(FLOOR, flat, INSIDE).value)
    assert kept.contrast(FLOOR, halves(0.2), INSIDE).value == pytest.approx(1, abs=0.1)


def test_black_windows_and_small_pictures_have_none() -> None:
    black = np.zeros(SIZE)
    assert math.isnan(kept.contrast(FLOOR, (black, black), INSIDE).value)
    assert kept.contrast(black, (FLOOR, FLOOR), INSIDE).value == 0
    tiny = np.ones((4, 9))
    assert math.isnan(kept.contrast(tiny, (tiny, tiny), tiny > 0).value)


def test_the_mean_is_that_of_the_window() -> None:
    plane = np.random.default_rng(9).random((11, 13))
    means = kept.window_mean(plane)
    assert means[4, 6] == pytest.approx(plane[2:7, 4:9].mean())
    assert not means[:2].any()
    assert not means[:, -2:].any()


TEXTURE = 0.5 + 0.2 * np.sign(np.random.default_rng(11).random((60, 80, 1)) - 0.5) * np.ones(3)


def detail(shown: np.ndarray, truth: tuple[np.ndarray, np.ndarray] = (TEXTURE, TEXTURE)) -> float:
    return kept.detail(shown, truth, np.ones(TEXTURE.shape[:2], np.bool_)).value


def test_a_faded_texture_keeps_its_share_of_detail() -> None:
    assert [detail(0.5 + share * (TEXTURE - 0.5)) for share in (1, 0.3, 0)] == pytest.approx([1, 0.3, 0])
    assert detail(TEXTURE + 0.1) == pytest.approx(1)


def test_a_blurred_texture_loses_detail() -> None:
    blurred = (TEXTURE + np.roll(TEXTURE, 1, axis=0) + np.roll(TEXTURE, 1, axis=1)) / 3
    assert detail(blurred) < 0.5
    assert detail((blurred + TEXTURE) / 2) == pytest.approx((detail(blurred) + 1) / 2)


def test_noise_of_picture_and_truth_is_no_detail() -> None:
    rng = np.random.default_rng(12)
    picture, *truth = (TEXTURE + rng.normal(0, 0.05, TEXTURE.shape) for _ in range(3))
    assert detail(picture, (truth[0], truth[1])) == pytest.approx(1, abs=0.05)


def test_the_laplacian_is_that_of_luminance() -> None:
    y, x = np.indices((8, 9))
    bowl = (0.1 * x**2 + 0.02 * y**2 + x * y)[..., None] * np.ones(3)
    np.testing.assert_allclose(kept.laplacian(bowl), np.pad(np.full((6, 7), 0.24), 1), atol=1e-12)
