"""Properties of EAW's oracle: what must hold whatever the kernels do (docs/algorithm.md)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.lib.stride_tricks import sliding_window_view
from numpy.testing import assert_allclose, assert_array_equal

from svgf_cl import Eaw
from svgf_cl.oracle.eaw import Oracle, atrous
from svgf_cl.oracle.temporal import demodulate
from tests.svgf_cl.oracle.scenes import SHAPE, bumpy, guides_of, wall

SPLINES = {"3x3": np.array((1, 2, 1)) / 4, "5x5": np.array((1, 4, 6, 4, 1)) / 16}


class TestAtrous:
    def test_worked_example(self) -> None:
        """Two pixels of one tilted surface, by hand; of the light's three channels each counts."""
        normal = np.array(((0, 0, 1), (0, 0.1, np.sqrt(1 - 0.01))))
        guides = guides_of(wall((1, 2), depth=((2, 2.5),), normal=normal[None]))
        one, other = np.array((1.0, 2.0, 3.0)), np.array((1.5, 1.0, 3.25))
        color = atrous(np.array([[[one, other]]]), guides, 1, Eaw(taps="5x5", sigma_color=2))
        w_z, w_n = np.exp(-0.5 / (0.5 + 1e-3 * 2)), np.exp(128 * (np.sqrt(1 - 0.01) - 1))
        w_c = np.exp(-(0.5**2 + 1**2 + 0.25**2) / 2**2)
        centre, tap = (3 / 8) ** 2, 3 / 8 * 1 / 4 * w_z * w_n * w_c
        assert_allclose(color[0, 0, 0], (centre * one + tap * other) / (centre + tap), rtol=1e-5)

    @pytest.mark.parametrize("level", [1, 2, 3])
    def test_tolerance_halves_with_every_level(self, level: int) -> None:
        """Two pixels as far apart as the level's taps."""
        step = 2 ** (level - 1)
        picture = np.zeros((1, 1, step + 1, 3))
        picture[..., -1, :] = 0.125
        color = atrous(picture, guides_of(wall((1, step + 1))), level, Eaw(sigma_color=0.5))
        w = 1 / 8 * np.exp(-3 * (0.125 * step / 0.5) ** 2)
        assert_allclose(color[0, 0, 0], 0.125 * w / (1 / 4 + w))

    @pytest.mark.parametrize(("taps", "spline"), SPLINES.items())
    def test_tolerating_all_it_is_the_spline(self, rng: np.random.Generator, taps: str, spline: np.ndarray) -> None:
        picture = rng.random((*SHAPE, 3))
        count = len(spline)
        windows = sliding_window_view(picture, (count, count), axis=(0, 1))
        smooth = np.einsum("yxcij,i,j->yxc", windows, spline, spline)
        inside = slice(count // 2, -(count // 2))
        color = atrous(picture[None], guides_of(wall()), 1, Eaw(taps=taps, sigma_color=1e6))
        assert_allclose(color[0][inside, inside], smooth, rtol=1e-10)

    def test_tolerating_nothing_it_changes_nothing(self, rng: np.random.Generator) -> None:
        picture = rng.random((2, *SHAPE, 3))
        assert_array_equal(atrous(picture, guides_of(wall()), 1, Eaw(sigma_color=1e-6)), picture)

    def test_signals_are_told_apart_each_by_its_own_light(self, rng: np.random.Generator) -> None:
        one, other = rng.random((2, 1, *SHAPE, 3))
        guides = guides_of(bumpy(rng))
        both = atrous(np.concatenate((one, other)), guides, 2, Eaw())
        assert_array_equal(both, np.concatenate([atrous(each, guides, 2, Eaw()) for each in (one, other)]))

    def test_misses_neither_give_nor_take(self, rng: np.random.Generator) -> None:
        frame = bumpy(rng, misses=0.3)
        miss = ~guides_of(frame).hit
        bright = replace(frame, color=np.where(miss[..., None], np.float32(1e6), frame.color))
        dull, glaring = (Oracle(SHAPE, Eaw()).denoise(f) for f in (frame, bright))
        assert_allclose(dull[miss], frame.color[miss], rtol=1e-12)
        assert_allclose(glaring[miss], 1e6)
        assert_array_equal(dull[~miss], glaring[~miss])


class TestOracle:
    def test_colour_history_is_the_accumulated_light(self, rng: np.random.Generator) -> None:
        """Whatever the levels make of it, it is the mean of all frames."""
        colors = rng.gamma(2, 1, (8, *SHAPE, 3)).astype(np.float32)
        oracle = Oracle(SHAPE, Eaw(alpha_color=0))
        for color in colors:
            oracle.denoise(wall(color=color))
        assert_allclose(oracle.stages["accumulated"][0], colors.mean(axis=0, dtype=np.float64))
        assert np.abs(oracle.stages["level_1"] - oracle.stages["accumulated"]).max() > 0.01

    def test_alpha_of_moments_is_that_of_colour(self, rng: np.random.Generator) -> None:
        oracle = Oracle(SHAPE, Eaw(alpha_color=0.75))
        for value in (1.0, 5.0):
            oracle.denoise(wall(color=value))
        assert_allclose(oracle.stages["mean"], 4.0)

    def test_levels_follow_one_another(self, rng: np.random.Generator) -> None:
        frame, settings = bumpy(rng), Eaw(iterations=3)
        oracle = Oracle(SHAPE, settings)
        oracle.denoise(frame)
        picture, guides = demodulate(frame)
        for level in (1, 2, 3):
            picture = atrous(picture, guides, level, settings)
            assert_array_equal(oracle.stages[f"level_{level}"], picture)

    def test_scaling_light_and_its_tolerance_scales_the_picture(self, rng: np.random.Generator) -> None:
        frames = [bumpy(rng) for _ in range(3)]
        plain, bright = Oracle(SHAPE, Eaw(sigma_color=1)), Oracle(SHAPE, Eaw(sigma_color=1024))
        for frame in frames:
            expected = 1024 * plain.denoise(frame)
            assert_allclose(bright.denoise(replace(frame, color=1024 * frame.color)), expected, rtol=1e-9)

    def test_noise_shrinks(self, rng: np.random.Generator) -> None:
        """That of a standard deviation of a quarter of what is tolerated."""
        shape = (48, 48)
        oracle = Oracle(shape, Eaw())
        for _ in range(4):
            noisy = wall(shape, color=rng.normal(2, 0.25, (*shape, 1)) * np.ones(3))
            out = oracle.denoise(noisy)
        assert np.std(out) < 0.1 * np.std(noisy.color)
        assert_allclose(out.mean(), 2, atol=0.01)
