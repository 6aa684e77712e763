"""Sky, normals of any length or none, and planes seen edge-on."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from svgf_cl import Frame
from tests.frames import FACING, SHAPE, noise
from tests.hard.variants import Variant, on

# Normals are stored and weighed, in each way once; TAA, which takes in neighbours, must not take in the sky.
variants = on("precise", "precise, two signals, TAA", "fp16", "fast", "Kalman")
# The length of history is kept, and TAA and the signals share it.
of_lengths = on("precise", "fp16")

ABOVE = np.indices(SHAPE)[0] < 20  # where the sky is


class TestSky:
    @pytest.fixture
    def light(self) -> np.ndarray:
        """1e-2 to 1e4 without any pattern."""
        return 10 ** np.random.default_rng(0).uniform(-2, 4, (*SHAPE, 3))

    @pytest.mark.parametrize("miss", [{"depth": np.inf}, {"depth": 0}, {"depth": 3e38}, {"normal": 0}], ids=str)
    @variants
    def test_passes_through(self, variant: Variant, light: np.ndarray, miss: dict) -> None:
        for picture in variant.pictures([variant.wall(light, **miss)] * 3):
            assert variant.errors(picture, light).max() <= 4 * variant.rounding

    @pytest.mark.parametrize("sky", [1e4, 1e10])
    @variants
    def test_leaves_the_ground_alone(self, variant: Variant, sky: float) -> None:
        """To the bit; but antialiasing looks at the pixels next to it."""
        ground = ~ABOVE if not variant.settings.taa else np.indices(SHAPE)[0] > 20
        depth = np.where(ABOVE, np.inf, 4.0)
        rng = np.random.default_rng(1)
        lights = [rng.exponential(0.5, (*SHAPE, 3)) for _ in range(4)]

        def under(sky: float) -> list[Frame]:
            return [variant.wall(np.where(ABOVE[..., None], sky, light), depth=depth) for light in lights]

        for got, expected in zip(variant.pictures(under(sky)), variant.pictures(under(0.0)), strict=True):
            assert_array_equal(got[ground], expected[ground])

    @variants
    def test_is_left_alone_by_the_ground(self, variant: Variant, light: np.ndarray) -> None:
        lights = np.where(ABOVE[..., None], light, 1e10)
        for picture in variant.pictures([variant.wall(lights, depth=np.where(ABOVE, np.inf, 4.0))] * 3):
            assert variant.errors(picture, light)[ABOVE].max() <= 4 * variant.rounding


class TestNormals:
    @variants
    def test_length_does_not_matter(self, variant: Variant) -> None:
        rng = np.random.default_rng(2)
        normal = FACING + rng.normal(0, 0.1, (*SHAPE, 3))
        normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
        length = 10 ** rng.uniform(-5.5, 9.5, (*SHAPE, 1))
        lights = [rng.exponential(0.5, (*SHAPE, 3)) for _ in range(4)]
        unit = variant.pictures([variant.wall(light, normal=normal) for light in lights])
        stretched = variant.pictures([variant.wall(light, normal=length * normal) for light in lights])
        for got, expected in zip(stretched, unit, strict=True):
            assert variant.errors(got, expected).max() <= variant.error

    @variants
    def test_none_is_nothing_hit(self, variant: Variant) -> None:
        nothing = np.where(noise()[..., :1] < 0.2, 0.0, FACING)
        missed = np.where(nothing.any(axis=-1), 4.0, np.inf)
        light = noise(3)
        for got, expected in zip(
            variant.pictures([variant.wall(light, normal=nothing)] * 4),
            variant.pictures([variant.wall(light, depth=missed)] * 4),
            strict=True,
        ):
            assert_array_equal(got, expected)


class TestGrazing:
    """A floor up to the horizon: from one row to the next it lies up to three times as far away."""

    HORIZON, FOCAL, STRIDE = 9.5, 60.0, 0.02

    def floor(self, variant: Variant, light: np.ndarray) -> Frame:
        """As a camera sees it that walks ahead, a stride a frame, at a height of 1."""
        y, x = np.indices(SHAPE, np.float64)
        hit = y > self.HORIZON
        depth = np.where(hit, self.FOCAL / np.where(hit, y - self.HORIZON, 1), np.inf)
        nearer = 1 / (1 + self.STRIDE / depth)  # by which the previous frame showed it closer to the vanishing point
        motion = np.stack([(x - SHAPE[1] / 2) * (nearer - 1), (y - self.HORIZON) * (nearer - 1), self.STRIDE * hit], -1)
        return variant.wall(light, depth=depth, motion=motion, normal=np.where(hit[..., None], (0, 1, 0), 0))

    @pytest.fixture
    def frames(self, variant: Variant) -> list[Frame]:
        rng = np.random.default_rng(4)
        return [self.floor(variant, rng.exponential(0.5, (*SHAPE, 1))) for _ in range(8)]

    @variants
    def test_follows_the_oracle(self, variant: Variant, frames: list[Frame]) -> None:
        variant.assert_follows_oracle(frames)

    @of_lengths
    def test_keeps_its_history(self, variant: Variant, frames: list[Frame]) -> None:
        den = variant.denoiser()
        for frame in frames:
            den.denoise(frame)
        assert np.mean(den.stage("history_length")[10:] > 7) > 0.95

    @variants
    def test_is_filtered(self, variant: Variant, frames: list[Frame]) -> None:
        """To a tenth of the noise, whose deviation is 0.5, as far as the last rows before the horizon."""
        *_, last = variant.pictures(frames)
        assert last[12:].std() < 0.05
        assert_allclose(last[12:].mean(), 0.5, rtol=0.05)
