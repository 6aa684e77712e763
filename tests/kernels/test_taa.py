"""taa.cl: history is kept along motion as far as the neighbourhood allows."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from svgf_cl import Frame
from tests.denoising import feed
from tests.frames import SHAPE, SPLIT, noise, only, wall
from tests.oracle import antialiased_cases, assert_follows_oracle

LUMA = np.array((0.25, 0.5, 0.25))


@antialiased_cases
def test_follows_the_oracle(case: str) -> None:
    assert_follows_oracle(case, "antialiased", "resolved")


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
    def grey(tone: float, *, spots: float) -> Frame:
        """A tone-mapped grey with brighter and darker rows, which let all history of rows between them pass."""
        rows = np.arange(SHAPE[0])[:, None, None] % 3
        tones = np.select([rows == 0, rows == 1], [tone - spots, tone + spots], tone) * np.ones((*SHAPE, 3))
        return glowing(tones / (1 - tones))

    _, den = feed(*[grey(0.2, spots=0.0)] * 9, grey(0.4, spots=0.3), taa=True, alpha_taa=alpha)
    assert_allclose(den.stage("antialiased")[2:-1:3, :, 0], expected, rtol=1e-5)


@pytest.mark.parametrize("motion", [(1.0, 0.0, 0.0), (0.0, -2.0, 0.0), (17.0, 3.0, 0.0)])
def test_pan_by_whole_pixels_moves_the_history(motion: tuple[float, float, float]) -> None:
    dx, dy = int(motion[0]), int(motion[1])
    first = noise()
    moved = np.roll(first, (-dy, -dx), axis=(0, 1))
    _, den = feed(*[glowing(first)] * 9, glowing(0.5 * moved + 0.5 * noise(1), motion=motion), taa=True, alpha_taa=0)
    now = tone(0.5 * moved + 0.5 * noise(1))
    around = np.stack([np.roll(now, (i, j), axis=(0, 1)) for i in (-1, 0, 1) for j in (-1, 0, 1)])
    expected = 0.9 * np.clip(tone(moved), around.min(axis=0), around.max(axis=0)) + 0.1 * now
    y, x = np.indices(SHAPE)
    seen = (x >= 1) & (x + max(dx, 1) < SHAPE[1]) & (y >= max(-dy, 1)) & (y + max(dy, 1) < SHAPE[0])
    assert_allclose(den.stage("antialiased")[seen, 0], expected[seen], rtol=1e-5)


def tone(picture: np.ndarray) -> np.ndarray:
    """Tone-mapped luma."""
    return (picture @ LUMA) / (1 + picture @ LUMA)


@pytest.mark.parametrize(
    "motion", [(100.0, 0.0, 0.0), (np.nan, 0.0, 0.0), (0.0, np.nan, 0.0), (0.0, -np.inf, 0.0), (3e38, 0.0, 0.0)]
)
def test_no_history_from_outside_the_image(motion: tuple[float, float, float]) -> None:
    out, _ = feed(glowing(noise()), glowing(noise(1), motion=motion), taa=True)
    assert_allclose(out, noise(1), rtol=1e-5, atol=1e-6)


def test_bright_light_survives_tone_mapping() -> None:
    assert_allclose(feed(glowing(1e4))[0], feed(glowing(1e4), taa=True)[0], rtol=5e-3)


@pytest.mark.parametrize("brightness", [1e4, 1e30, 3e38])
def test_firefly_goes_no_further_than_its_pixel(brightness: float) -> None:
    picture = np.full((*SHAPE, 3), 0.5)
    picture[5, 20] = (brightness, 0, brightness)
    out, _ = feed(*[glowing(picture)] * 3, taa=True)
    assert np.isfinite(out).all()
    picture[5, 20] = out[5, 20] = 0
    assert_allclose(out, picture, rtol=1e-5)
