"""taa.cl: history is kept along motion as far as the neighbourhood allows."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from svgf_cl import Denoiser, Frame, Settings
from tests.denoising import feed
from tests.frames import SHAPE, SPLIT, noise, only, wall

LUMA = np.array((0.25, 0.5, 0.25))


def glowing(picture: Any, **given: Any) -> Frame:
    """A picture that no other stage changes: emission alone."""
    return only(wall(direct=0.0, indirect=0.0, emission=picture, albedo=1.0, id=1, **given), SPLIT)


def test_first_frame_passes_through() -> None:
    assert_allclose(feed(glowing(noise()), taa=True)[0], noise(), rtol=1e-5, atol=1e-6)


def test_constant_image_stays_constant() -> None:
    assert_allclose(feed(*[glowing(0.5)] * 8, taa=True)[0], 0.5, rtol=1e-5)


def test_history_unlike_its_neighbourhood_is_dropped() -> None:
    assert_allclose(feed(glowing(0.9), glowing(0.1), taa=True)[0], 0.1, rtol=1e-5)


@pytest.mark.parametrize(("alpha", "expected"), [(0.0, 0.22), (0.05, 0.22), (0.25, 0.25), (1.0, 0.4)])
def test_alpha_is_the_share_of_the_new_frame_but_at_least_1_in_10_of_10(alpha: float, expected: float) -> None:
    def grey(light: float, *, spots: float) -> Frame:
        """A grey with brighter and darker rows, which let all history of rows between them pass."""
        rows = np.arange(SHAPE[0])[:, None, None] % 3
        return glowing(np.select([rows == 0, rows == 1], [light - spots, light + spots], light) * np.ones((*SHAPE, 3)))

    out, _ = feed(*[grey(0.2, spots=0.0)] * 9, grey(0.4, spots=0.3), taa=True, alpha_taa=alpha)
    assert_allclose(out[2:-1:3], expected, rtol=1e-5)


@pytest.mark.parametrize("motion", [(1.0, 0.0, 0.0), (0.0, -2.0, 0.0), (17.0, 3.0, 0.0)])
def test_pan_by_whole_pixels_moves_the_history(motion: tuple[float, float, float]) -> None:
    dx, dy = int(motion[0]), int(motion[1])
    first = noise()
    moved = np.roll(first, (-dy, -dx), axis=(0, 1))
    _, den = feed(*[glowing(first)] * 9, glowing(0.5 * moved + 0.5 * noise(1), motion=motion), taa=True, alpha_taa=0)
    now = (0.5 * moved + 0.5 * noise(1)) @ LUMA
    around = np.stack([np.roll(now, (i, j), axis=(0, 1)) for i in (-1, 0, 1) for j in (-1, 0, 1)])
    expected = 0.9 * np.clip(moved @ LUMA, around.min(axis=0), around.max(axis=0)) + 0.1 * now
    y, x = np.indices(SHAPE)
    seen = (x >= 1) & (x + max(dx, 1) < SHAPE[1]) & (y >= max(-dy, 1)) & (y + max(dy, 1) < SHAPE[0])
    assert_allclose(den.stage("antialiased")[seen, 0], expected[seen], rtol=1e-5)


@pytest.mark.parametrize(
    "motion", [(100.0, 0.0, 0.0), (np.nan, 0.0, 0.0), (0.0, np.nan, 0.0), (0.0, -np.inf, 0.0), (3e38, 0.0, 0.0)]
)
def test_no_history_from_outside_the_image(motion: tuple[float, float, float]) -> None:
    out, _ = feed(glowing(noise()), glowing(noise(1), motion=motion), taa=True)
    assert_allclose(out, noise(1), rtol=1e-5, atol=1e-6)


class TestEnergy:
    """What the neighbourhood allows keeps its mean over time; with `alpha_taa` 0 all frames count alike."""

    def test_noise_keeps_its_mean(self) -> None:
        den = Denoiser(SHAPE, settings=Settings(taa=True))
        pictures = [noise(seed) for seed in range(40)]
        out = [den.denoise(glowing(picture)) for picture in pictures]
        assert_allclose(np.mean(out[10:]), np.mean(pictures[10:]), rtol=5e-3)

    def test_bright_pixels_that_move_about_keep_their_mean(self) -> None:
        column = np.arange(SHAPE[1])[:, None]
        frames = [glowing(np.where((column + t) % 3, 0.0, 10.0) * np.ones((*SHAPE, 3))) for t in range(3)]
        out, _ = feed(*frames * 8, taa=True, alpha_taa=0)
        assert_allclose(out[:, 1:-1], 10 / 3, rtol=1e-5)

    def test_bright_edge_under_jitter_becomes_the_mean_over_a_pixel(self) -> None:
        """An edge at 10.3: a fifth of pixel 10 lies behind it."""
        column = np.arange(SHAPE[1])[:, None]
        jitter = (np.random.default_rng(0).permutation(20) + 0.5) / 20 - 0.5
        frames = [glowing(np.where(column + j > 10.3, 100.0, 0.0) * np.ones((*SHAPE, 3))) for j in jitter]
        out, _ = feed(*frames, taa=True, alpha_taa=0)
        expected = np.select([column < 10, column == 10], [0.0, 20.0], 100.0)
        assert_allclose(out, np.broadcast_to(expected, out.shape), rtol=1e-5)


class TestPixelFilter:
    def test_spreads_a_pixel_over_its_neighbours(self) -> None:
        picture = np.zeros((*SHAPE, 3))
        picture[5, 20] = (3.0, 2.0, 1.0)
        out, _ = feed(glowing(picture), taa=True, pixel_filter=0.15)
        weights = np.array((0.15, 0.7, 0.15))
        picture[4:7, 19:22] = weights[:, None, None] * weights[:, None] * picture[5, 20]
        assert_allclose(out, picture, rtol=1e-5, atol=1e-6)

    def test_knows_nothing_beyond_the_border(self) -> None:
        picture = np.zeros((*SHAPE, 3))
        picture[:, -1] = 1
        out, _ = feed(glowing(picture), taa=True, pixel_filter=0.2)
        picture[:, -2:] = np.array((0.2, 0.6 / 0.8))[:, None]
        assert_allclose(out, picture, rtol=1e-5, atol=1e-6)


@pytest.mark.parametrize("brightness", [1e4, 1e10])
def test_bright_light_survives(brightness: float) -> None:
    assert_allclose(feed(*[glowing(brightness)] * 2, taa=True)[0], brightness, rtol=1e-5)


@pytest.mark.parametrize("brightness", [1e4, 1e30, 3e38])
def test_firefly_goes_no_further_than_its_pixel(brightness: float) -> None:
    picture = np.full((*SHAPE, 3), 0.5)
    picture[5, 20] = (brightness, 0, brightness)
    out, _ = feed(*[glowing(picture)] * 3, taa=True)
    assert np.isfinite(out).all()
    picture[5, 20] = out[5, 20] = 0
    assert_allclose(out, picture, rtol=1e-5)
