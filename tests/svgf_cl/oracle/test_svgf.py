"""Properties of SVGF's oracle: what must hold whatever the kernels do (docs/algorithm.md, sections 3 and 4)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from svgf_cl import Settings
from svgf_cl.frame import Frame
from svgf_cl.oracle.spatial import variance
from svgf_cl.oracle.svgf import Oracle, atrous
from svgf_cl.oracle.taps import Array, luminance
from svgf_cl.oracle.temporal import Accumulated, demodulate, temporal
from tests.svgf_cl.oracle.scenes import SHAPE, bumpy, guides_of, wall


class TestVariance:
    def test_short_history_looks_around(self, rng: np.random.Generator) -> None:
        illumination, guides = demodulate(wall(color=rng.random((*SHAPE, 3))))
        fresh = temporal(illumination, guides, None, Settings(), 0.2)
        patch = fresh.mean[0, 2:9, 3:10]
        assert_allclose(variance(fresh, guides, Settings())[0, 5, 6], 4 * patch.var())

    def test_long_history_is_taken_at_its_word(self, rng: np.random.Generator) -> None:
        guides = guides_of(bumpy(rng))
        known = rng.random((1, *SHAPE))
        past = Accumulated(np.zeros((1, *SHAPE, 3)), rng.random((1, *SHAPE)), known, np.full(SHAPE, 3.5))
        assert_array_equal(variance(past, guides, Settings()), np.where(guides.hit, known, 0))


class TestAtrous:
    def test_worked_example(self) -> None:
        """Two pixels of one tilted surface, by hand."""
        normal = np.array(((0, 0, 1), (0, 0.1, np.sqrt(1 - 0.01))))
        _, guides = demodulate(wall((1, 2), depth=((2, 2.5),), normal=normal[None]))
        picture, var = np.ones((1, 1, 2, 3)) * np.array((1.0, 3.0))[:, None], np.array((((4.0, 1.0),),))
        color, after = atrous(picture, var, guides, 1, Settings(taps="5x5"))
        smooth = (4 / 2 + 1 / 4) / (3 / 4)
        w_z, w_n = np.exp(-0.5 / (0.5 + 1e-3 * 2)), np.exp(128 * (np.sqrt(1 - 0.01) - 1))
        w_l = np.exp(-2 / (4 * np.sqrt(smooth) + 1e-3))
        centre, tap = (3 / 8) ** 2, 3 / 8 * 1 / 4 * w_z * w_n * w_l
        assert_allclose(color[0, 0, 0], (centre + 3 * tap) / (centre + tap), rtol=1e-5)
        assert_allclose(after[0, 0, 0], (4 * centre**2 + tap**2) / (centre + tap) ** 2, rtol=1e-5)

    @pytest.mark.parametrize("level", [1, 3])
    def test_variance_of_independent_noise(self, rng: np.random.Generator, level: int) -> None:
        """Where all weights are 1 the variance shrinks by (sum h^2)^2, and so does the noise itself."""
        shape, h = (96, 96), np.array((1, 4, 6, 4, 1)) / 16
        illumination, guides = demodulate(wall(shape, color=1 + rng.random((*shape, 1)) * np.ones(3)))
        known = np.full((1, *shape), 1e12)
        filtered, var = atrous(illumination, known, guides, level, Settings(taps="5x5"))
        edge = 2 * 2 ** (level - 1)
        inner = np.s_[0, edge:-edge, edge:-edge]
        factor = (h**2).sum() ** 2
        assert_allclose(var[inner], 1e12 * factor, rtol=1e-6)
        assert_allclose(luminance(filtered)[inner].var(), factor / 12, rtol=0.15)

    def test_misses_neither_give_nor_take(self, rng: np.random.Generator) -> None:
        frame = bumpy(rng, misses=0.3)
        miss = ~guides_of(frame).hit
        bright = replace(frame, color=np.where(miss[..., None], np.float32(1e6), frame.color))
        dull, glaring = (Oracle(SHAPE, Settings()).denoise(f) for f in (frame, bright))
        assert_allclose(dull[miss], frame.color[miss], rtol=1e-12)
        assert_allclose(glaring[miss], 1e6)
        assert_array_equal(dull[~miss], glaring[~miss])


class TestOracle:
    def test_colour_history_is_the_first_level(self, rng: np.random.Generator) -> None:
        """But the moments are kept as they were accumulated."""
        oracle = Oracle(SHAPE, Settings())
        first, second = (wall(color=rng.random((*SHAPE, 3))) for _ in range(2))
        oracle.denoise(first)
        assert oracle.past is not None
        kept = oracle.past.stages
        assert (kept["level_1"] != kept["level_2"]).any()
        oracle.denoise(second)
        now = oracle.stages
        assert_allclose(now["accumulated"], (kept["level_1"] + now["demodulated"]) / 2)
        innovation = luminance(now["demodulated"]) - kept["mean"]
        assert_allclose(now["moment_variance"], (kept["moment_variance"] + innovation**2 / 2) / 2)

    def test_static_scene_without_forgetting_is_the_mean(self, rng: np.random.Generator) -> None:
        """On a slope so picky about depth that no two pixels mix, where every filter level is the identity."""
        y, x = np.indices(SHAPE)
        colors = rng.gamma(2, 1, (32, *SHAPE, 3)).astype(np.float32)
        picky = Settings(alpha_color=0, alpha_moments=0, sigma_depth=1e-3, depth_slope_floor=1e-6)
        oracle = Oracle(SHAPE, picky)
        for color in colors:
            out = oracle.denoise(wall(depth=4 + x + 100 * y, color=color))
        luma = luminance(colors.astype(np.float64))
        assert_array_equal(oracle.stages["history_length"], 32)
        assert_allclose(out, colors.mean(axis=0, dtype=np.float64))
        assert_allclose(oracle.stages["mean"][0], luma.mean(axis=0))
        assert_allclose(oracle.stages["moment_variance"][0], luma.var(axis=0))

    def test_filtered_static_wall_nears_the_truth(self, rng: np.random.Generator) -> None:
        oracle = Oracle(SHAPE, Settings(alpha_color=0, alpha_moments=0, iterations=1))
        errors = [np.std(oracle.denoise(wall(color=rng.gamma(1, 1, (*SHAPE, 3))))) for _ in range(64)]
        assert errors[63] < 0.4 * errors[3]
        assert errors[3] < 0.4 * errors[0]

    def run(self, frames: list[Frame]) -> Array:
        oracle = Oracle(SHAPE, Settings())
        return [oracle.denoise(frame) for frame in frames][-1]

    def test_exposure_does_not_matter(self, rng: np.random.Generator) -> None:
        frames = [bumpy(rng) for _ in range(3)]
        bright = [replace(frame, color=frame.color * np.float64(1e3)) for frame in frames]
        assert_allclose(self.run(bright), 1e3 * self.run(frames), rtol=1e-7)

    def test_noise_shrinks(self, rng: np.random.Generator) -> None:
        shape = (48, 48)
        oracle = Oracle(shape, Settings())
        for _ in range(4):
            noisy = wall(shape, color=rng.gamma(0.5, 2, (*shape, 1)) * np.ones(3))
            out = oracle.denoise(noisy)
        assert np.std(out) < 0.1 * np.std(noisy.color)
        assert_allclose(out.mean(), 1, atol=0.1)
