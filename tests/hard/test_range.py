"""Light of any strength in one frame, down to nothing; and what is no light: zero, negative, denormal; any albedo."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from svgf_cl import Frame
from tests.frames import FACING, SHAPE, bumpy_sequence, noise
from tests.hard.variants import Variant, on

# Light of any strength goes through storage, weights and TAA, and each ends or rounds somewhere else: each once.
variants = on("precise", "precise, two signals, TAA", "fp16", "fast", "Kalman")
# Made safe as it comes in, before it is stored or weighed; each signal for itself.
of_input = on("precise", "precise, two signals, TAA")

# Number of the tile, 8x8 pixels, that each pixel lies in, (H, W, 1).
TILE = (np.indices(SHAPE).transpose(1, 2, 0) // 8) @ ((5,), (1,))


@variants
def test_light_of_16_orders_of_magnitude_follows_the_oracle(variant: Variant) -> None:
    rng = np.random.default_rng(1)
    frames = [variant.wall(10 ** rng.uniform(-8, 8, (*SHAPE, 3))) for _ in range(4)]
    variant.assert_follows_oracle(frames, error=variant.outshone)


class TestDimBesideBright:
    """Tiles lit 1e8, 1e-8 and so on to 10 and 0.1: three times as far away as those to their left, facing elsewhere."""

    @pytest.fixture
    def light(self) -> np.ndarray:
        """Of every pixel, (H, W, 1)."""
        return 10 ** (np.linspace(8, 1, TILE.max() + 1)[TILE] * np.where(TILE % 2, -1, 1))

    @pytest.fixture
    def frames(self, variant: Variant, light: np.ndarray) -> list[Frame]:
        surface = {"normal": np.where(TILE % 2, FACING, (1.0, 0.0, 0.0)), "depth": 3.0 ** TILE[..., 0]}
        rng = np.random.default_rng(3)
        return [variant.wall(light * rng.uniform(0.9, 1.1, (*SHAPE, 1)), **surface) for _ in range(5)]

    @variants
    def test_follows_the_oracle(self, variant: Variant, frames: list[Frame]) -> None:
        variant.assert_follows_oracle(frames)

    @variants
    def test_each_tile_keeps_its_own_light(self, variant: Variant, frames: list[Frame], light: np.ndarray) -> None:
        *_, last = variant.pictures(frames)
        held = (light > 100 * variant.least) & (light < variant.greatest) & np.ones(3, bool)
        assert_allclose(last[held], np.broadcast_to(light, last.shape)[held], rtol=0.1)


@pytest.mark.parametrize("scale", [2.0**-8, 2.0**8])
@variants
def test_exposure_scales_the_picture_and_nothing_else(variant: Variant, scale: float) -> None:
    rng = np.random.default_rng(4)
    lights = [rng.exponential(0.5, (*SHAPE, 3)) for _ in range(5)]
    once = variant.pictures([variant.wall(light) for light in lights])
    scaled = variant.pictures([variant.wall(scale * light) for light in lights])
    for got, expected in zip(scaled, once, strict=True):
        assert variant.errors(got, scale * expected).max() <= variant.error


@variants
def test_darkness_stays_dark(variant: Variant) -> None:
    for picture in variant.pictures([variant.wall(0)] * 4):
        assert_array_equal(picture, 0)


@variants
def test_light_comes_back_after_darkness(variant: Variant) -> None:
    variant.assert_follows_oracle([*[variant.wall(0)] * 6, *[variant.wall(noise())] * 3])


@of_input
def test_negative_light_is_none(variant: Variant) -> None:
    """To the bit, in each channel, and in all later frames."""
    frames = bumpy_sequence(variant.fields)
    lights = ["color"] if variant.signals == 1 else ["direct", "indirect"]
    rng = np.random.default_rng(5)
    keep = [{name: rng.random((*SHAPE, 3)) < 0.8 for name in lights} for _ in frames]

    def instead(factor: float) -> list:
        return [
            replace(frame, **{name: np.where(kept[name], v := getattr(frame, name), factor * v) for name in lights})
            for frame, kept in zip(frames, keep, strict=True)
        ]

    for got, expected in zip(variant.pictures(instead(-3)), variant.pictures(instead(0)), strict=True):
        assert_array_equal(got, expected)
