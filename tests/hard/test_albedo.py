"""Albedo from 0 to above 1: light on black is kept, texture stays sharp, and no pixel is made brighter than it came."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from tests.frames import SHAPE, noise
from tests.hard.variants import Variant, on

# Albedo is divided out of each signal and multiplied back on what storage kept; no weight and no TAA sees it.
variants = on("precise", "precise, two signals, TAA", "fp16")

STEPS = np.array([0, 1e-6, 1e-3, 0.02, 0.5, 1, 1.5, 8, 1e3])


@pytest.fixture
def albedo() -> np.ndarray:
    """Every step beside every other, in each channel apart."""
    return np.random.default_rng(0).choice(STEPS, (*SHAPE, 3))


@variants
def test_follows_the_oracle(variant: Variant, albedo: np.ndarray) -> None:
    rng = np.random.default_rng(1)
    lights = [rng.exponential(0.5, (*SHAPE, 1)) for _ in range(5)]
    frames = [variant.wall(light * np.clip(albedo, 1e-3, 1), albedo=albedo) for light in lights]
    variant.assert_follows_oracle(frames)


@variants
def test_texture_under_even_light_stays_as_it_is(variant: Variant, albedo: np.ndarray) -> None:
    seen = 0.5 * np.clip(albedo, 1e-3, 1)
    for picture in variant.pictures([variant.wall(seen, albedo=albedo)] * 3):
        assert_allclose(picture, seen, rtol=4 * variant.rounding, atol=4 * variant.rounding * seen.max())


@variants
def test_above_one_is_one(variant: Variant) -> None:
    light, bright = noise(), np.where(noise(1) < 0.1, 7.0, 1.0)
    for got, expected in zip(
        variant.pictures([variant.wall(light, albedo=bright)] * 3),
        variant.pictures([variant.wall(light)] * 3),
        strict=True,
    ):
        assert_array_equal(got, expected)


@variants
def test_light_on_black_is_kept(variant: Variant) -> None:
    for picture in variant.pictures([variant.wall(0.25, albedo=0)] * 3):
        assert_allclose(picture, 0.25, rtol=4 * variant.rounding)
