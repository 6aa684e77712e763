"""Properties of the oracle: what must hold whatever the kernels do (docs/algorithm.md)."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from svgf_cl.frame import Frame, Shape
from svgf_cl.oracle.svgf import (
    Accumulated,
    Guides,
    History,
    Reference,
    atrous,
    consistent,
    demodulate,
    foremost,
    modulate,
    surface_weight,
    taa,
    temporal,
    variance,
)
from svgf_cl.oracle.taps import (
    Array,
    catmull_rom_taps,
    depth_gradient,
    locate,
    luminance,
    reprojected,
    shifted,
    smoothed,
)
from svgf_cl.settings import Settings
from tests import frames
from tests.frames import FACING

SHAPE = (12, 14)


def wall(shape: Shape = SHAPE, **given: Any) -> Frame:
    """`frames.wall`, smaller: the oracle is slow."""
    return frames.wall(shape, **given)


def bumpy(rng: np.random.Generator, shape: Shape = SHAPE, misses: float = 0.1, **given: Any) -> Frame:
    """Random light, albedo, motion and a rough surface with holes."""
    hit = rng.random(shape) >= misses
    random = {
        "color": rng.random((*shape, 3)),
        "albedo": rng.random((*shape, 3)),
        "normal": (FACING + rng.normal(0, 0.1, (*shape, 3))) * hit[..., None],
        "depth": np.where(hit, rng.uniform(4, 5, shape), np.inf),
        "motion": rng.uniform(-1, 1, (*shape, 3)) * (1, 1, 0.05),
    }
    return wall(shape, **(random | given))


def guides_of(frame: Frame) -> Guides:
    return demodulate(frame)[1]


def history_of(frame: Frame, mean: Array | float, var: Array | float = 0.0, length: float = 1.0) -> History:
    """Return a one-signal history of grey light whose luminance moments are given."""
    mean = np.broadcast_to(mean, (1, *frame.shape)).astype(np.float64)
    grey = np.repeat(mean[..., None], 3, axis=-1)
    past = Accumulated(grey, mean, np.broadcast_to(var, mean.shape), np.full(frame.shape, length))
    return History(guides_of(frame), past)


def lengths(*frames: Frame, **chosen: Any) -> Array:
    """History length after a sequence."""
    reference = Reference(frames[0].shape, Settings(iterations=1, **chosen))
    for frame in frames:
        reference.denoise(frame)
    return reference.stages["history_length"]


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(2017)


class TestDemodulate:
    def test_modulate_undoes_it(self, rng: np.random.Generator) -> None:
        emission = rng.random((*SHAPE, 3)).astype(np.float32)
        frame = bumpy(rng, emission=emission, color=emission + rng.random((*SHAPE, 3)))
        assert_allclose(modulate(*demodulate(frame)), frame.color, atol=1e-12)

    def test_light_on_black_survives(self) -> None:
        illumination, guides = demodulate(wall(color=0.25, albedo=0.0))
        assert_allclose(illumination, 250, rtol=1e-6)
        assert_allclose(modulate(illumination, guides), 0.25)

    def test_one_infinite_channel_blackens_the_triple(self) -> None:
        assert_array_equal(demodulate(wall(color=(np.inf, 1, 1)))[0], 0)

    @pytest.mark.parametrize(
        "changes", [{"depth": np.inf}, {"depth": -1}, {"normal": 0}, {"normal": (np.nan, 0, 1)}, {"normal": 1e30}]
    )
    def test_miss(self, changes: dict[str, Any]) -> None:
        guides = guides_of(wall(**changes))
        for plane in (guides.hit, guides.normal, guides.depth):
            assert_array_equal(plane, 0)

    def test_normals_become_unit(self) -> None:
        assert_allclose(guides_of(wall(normal=(0, 3, 4))).normal[0, 0], (0, 0.6, 0.8))

    def test_bad_motion_points_out_of_the_image(self) -> None:
        guides = guides_of(wall(motion=(0, 0, np.nan)))
        assert_array_equal(guides.motion[0, 0], (-1e6, -1e6, 0))

    def test_motion_is_clamped(self) -> None:
        assert_array_equal(guides_of(wall(motion=(1e30, -1e30))).motion[0, 0], (1e6, -1e6, 0))


class TestTemporal:
    @settings(max_examples=25, deadline=None, derandomize=True)
    @given(
        seed=st.integers(0, 2**32 - 1),
        x=st.floats(0, 0.875, width=32),
        y=st.floats(0, 0.875, width=32),
        alpha=st.floats(0, 1),
    )
    def test_moments_are_the_raw_ones(self, seed: int, x: float, y: float, alpha: float) -> None:
        """M and V equal the exponential average of mu1, mu2 and mu2 - mu1^2, each interpolated as it is."""
        rng = np.random.default_rng(seed)
        past, new = wall(), wall(color=rng.random((*SHAPE, 3)), motion=(x, y))
        mean, var = rng.normal(0, 2, (2, *SHAPE))
        history = history_of(past, mean, var**2, length=3.0)
        illumination, guides = demodulate(new)
        result = temporal(illumination, guides, history, Settings(alpha_moments=alpha))

        def interpolate(plane: Array) -> Array:
            along_x = (1 - x) * plane[:, :-1] + x * plane[:, 1:]
            return (1 - y) * along_x[:-1] + y * along_x[1:]

        inner = np.s_[:-1, :-1]
        share, sample = max(1 / 4, alpha), luminance(illumination)[0][inner]
        mu1 = (1 - share) * interpolate(mean) + share * sample
        mu2 = (1 - share) * interpolate(var**2 + mean**2) + share * sample**2
        assert_allclose(result.mean[0][inner], mu1, atol=1e-10)
        assert_allclose(result.variance[0][inner], mu2 - mu1**2, atol=1e-10)

    def test_first_frame(self, rng: np.random.Generator) -> None:
        illumination, guides = demodulate(bumpy(rng))
        first = temporal(illumination, guides, None, Settings())
        assert_array_equal(first.illumination, illumination)
        assert_array_equal(first.mean, luminance(illumination))
        assert_array_equal(first.variance, 0)
        assert_array_equal(first.length, guides.hit)

    def test_static_scene_without_forgetting_is_the_mean(self, rng: np.random.Generator) -> None:
        """On a slope so picky about depth that no two pixels mix, where every filter level is the identity."""
        y, x = np.indices(SHAPE)
        colors = rng.gamma(2, 1, (32, *SHAPE, 3)).astype(np.float32)
        picky = Settings(alpha_color=0, alpha_moments=0, sigma_depth=1e-3, depth_slope_floor=1e-6)
        reference = Reference(SHAPE, picky)
        for color in colors:
            out = reference.denoise(wall(depth=4 + x + 100 * y, color=color))
        luma = luminance(colors.astype(np.float64))
        assert_array_equal(reference.stages["history_length"], 32)
        assert_allclose(out, colors.mean(axis=0, dtype=np.float64))
        assert_allclose(reference.stages["mean"][0], luma.mean(axis=0))
        assert_allclose(reference.stages["moment_variance"][0], luma.var(axis=0))

    def test_filtered_static_wall_nears_the_truth(self, rng: np.random.Generator) -> None:
        reference = Reference(SHAPE, Settings(alpha_color=0, alpha_moments=0, iterations=1))
        errors = [np.std(reference.denoise(wall(color=rng.gamma(1, 1, (*SHAPE, 3))))) for _ in range(64)]
        assert errors[63] < 0.4 * errors[3]
        assert errors[3] < 0.4 * errors[0]

    def test_alpha_bounds_the_new_share_from_below(self) -> None:
        illumination, guides = demodulate(wall(color=6))
        history = history_of(wall(), 1, 0.5, length=99.0)
        result = temporal(illumination, guides, history, Settings(alpha_color=0.2, alpha_moments=0.4))
        assert_allclose(result.illumination, 1 + 0.2 * 5)
        assert_allclose(result.mean, 1 + 0.4 * 5)
        assert_allclose(result.variance, 0.6 * (0.5 + 0.4 * 25))

    def test_length_stops_at_1024(self) -> None:
        illumination, guides = demodulate(wall())
        assert_array_equal(
            temporal(illumination, guides, history_of(wall(), 0.5, length=1024.0), Settings()).length, 1024
        )

    def test_one_pixel_pan_keeps_all_but_the_column_that_came_in(self) -> None:
        columns = np.arange(SHAPE[1])
        length = lengths(wall(id=columns + 1), wall(id=columns + 2, motion=(1, 0)))
        assert_array_equal(length[:, :-1], 2)
        assert_array_equal(length[:, -1], 1)

    def test_half_pixel_pan_interpolates(self, rng: np.random.Generator) -> None:
        mean = rng.random(SHAPE)
        illumination, guides = demodulate(wall(motion=(-0.5, 0)))
        result = temporal(illumination, guides, history_of(wall(), mean, length=3.0), Settings())
        assert_allclose(result.length, 4)
        assert_allclose(result.mean[0, :, 1:], 0.75 * (mean[:, :-1] + mean[:, 1:]) / 2 + 0.25 * 0.5)
        assert_allclose(result.mean[0, :, 0], 0.75 * mean[:, 0] + 0.25 * 0.5, err_msg="weights of taps outside count")

    @pytest.mark.parametrize(
        "change",
        [
            {"depth": 4.2},
            {"normal": (1, 0, 1)},
            {"id": 8},
            {"motion": (2.0 * SHAPE[1], 0)},
            {"motion": (0, -2.0 * SHAPE[0])},
            {"motion": (np.nan, 0)},
        ],
    )
    def test_disocclusion(self, change: dict[str, Any]) -> None:
        reference = Reference(SHAPE)
        for frame in (wall(id=7, color=1), wall(id=7, color=1), wall(**{"id": 7, "color": 3} | change)):
            reference.denoise(frame)
        assert_array_equal(reference.stages["history_length"], 1)
        assert_allclose(reference.stages["accumulated"], 3)
        assert_allclose(reference.stages["mean"], 3)
        assert_array_equal(reference.stages["moment_variance"], 0)

    def test_thin_geometry_is_found_beside_its_footprint(self) -> None:
        wire = np.where(np.arange(SHAPE[1]) == 6, 2, 1)
        motion = np.where(wire == 2, 1.0, 0.0)[None, :, None] * (1, 0)
        illumination, guides = demodulate(wall(id=wire, motion=motion))
        result = temporal(
            illumination, guides, history_of(wall(id=wire), np.where(wire == 2, 9, 1), length=1.0), Settings()
        )
        assert_array_equal(result.length, 2)
        assert_allclose(result.mean[0, :, 6], (9 + 0.5) / 2)

    def test_dolly_needs_the_expected_depth(self) -> None:
        far, near = wall(depth=4), wall(depth=3.5, motion=(0, 0))
        assert_array_equal(lengths(far, near), 1)
        assert_array_equal(lengths(far, wall(depth=3.5, motion=(0, 0, 0.5))), 2)

    def test_expectation_moves_along_the_surface(self) -> None:
        slope = 5 + 0.5 * np.indices(SHAPE)[1]
        guides = guides_of(wall(depth=slope, motion=(0, 0)))
        y, x = np.indices((1, *SHAPE))[1:]
        tight = Settings(depth_threshold=0)
        assert consistent(x + 3, y, guides, guides, tight)[0, :, :-3].all()
        flat = replace(guides, depth=np.roll(guides.depth, 3, axis=1))
        assert not consistent(x + 3, y, guides, flat, tight)[0, :, :-3].any()

    @pytest.mark.parametrize(("pixels", "same"), [(0.7, True), (0.8, False)])
    def test_depth_may_be_a_pixel_of_slope_off(self, pixels: float, same: bool) -> None:
        y, x = np.indices(SHAPE)
        guides = guides_of(wall(depth=8 + 0.5 * x - 0.25 * y))
        other = replace(guides, depth=guides.depth + pixels)
        assert (consistent(x[None], y[None], guides, other, Settings(depth_threshold=0)) == same).all()


class TestVariance:
    def test_short_history_looks_around(self, rng: np.random.Generator) -> None:
        illumination, guides = demodulate(wall(color=rng.random((*SHAPE, 3))))
        fresh = temporal(illumination, guides, None, Settings())
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
        color, after = atrous(picture, var, guides, 0, Settings(taps="5x5"))
        smooth = (4 / 2 + 1 / 4) / (3 / 4)
        w_z, w_n = np.exp(-0.5 / (0.5 + 1e-3 * 2)), np.exp(128 * (np.sqrt(1 - 0.01) - 1))
        w_l = np.exp(-2 / (4 * np.sqrt(smooth) + 1e-3))
        centre, tap = (3 / 8) ** 2, 3 / 8 * 1 / 4 * w_z * w_n * w_l
        assert_allclose(color[0, 0, 0], (centre + 3 * tap) / (centre + tap), rtol=1e-5)
        assert_allclose(after[0, 0, 0], (4 * centre**2 + tap**2) / (centre + tap) ** 2, rtol=1e-5)

    def test_depth_weight_of_a_distant_tap(self) -> None:
        y, x = np.indices(SHAPE)
        guides = guides_of(wall(depth=8 + 0.5 * x - 0.25 * y))
        weight = surface_weight(guides, depth_gradient(guides.depth), (2, -1), 4, Settings(taps="5x5", sigma_depth=2))
        slope = 2 * 0.5 + 0.25
        assert_allclose(weight[6, 3], np.exp(-4 * slope / (4 * (2 * slope + 1e-3 * 8 * 2))))

    def test_smoothed_variance_is_that_of_hits(self, rng: np.random.Generator) -> None:
        hit = guides_of(bumpy(rng, misses=0.3)).hit
        assert_allclose(smoothed(np.where(hit, 2.0, 100.0)[None], hit)[0][hit], 2)

    @pytest.mark.parametrize("offset", [(1, 0), (-2, 1), (2, 2)])
    def test_weight_is_symmetric_on_a_facing_surface(self, rng: np.random.Generator, offset: tuple[int, int]) -> None:
        guides = guides_of(wall(normal=FACING + rng.normal(0, 0.1, (*SHAPE, 3))))
        gradient = depth_gradient(guides.depth)
        there = surface_weight(guides, gradient, offset, 2, Settings(taps="5x5"))
        back = surface_weight(guides, gradient, (-offset[0], -offset[1]), 2, Settings(taps="5x5"))
        y, x, inside = shifted(offset, SHAPE, 2)
        assert_allclose(there[inside], back[y, x][inside], rtol=1e-12)
        assert 0 < there[inside].min() < there.max() < 1

    @pytest.mark.parametrize("level", [0, 2])
    def test_variance_of_independent_noise(self, rng: np.random.Generator, level: int) -> None:
        """Where all weights are 1 the variance shrinks by (sum h^2)^2, and so does the noise itself."""
        shape, h = (96, 96), np.array((1, 4, 6, 4, 1)) / 16
        illumination, guides = demodulate(wall(shape, color=1 + rng.random((*shape, 1)) * np.ones(3)))
        known = np.full((1, *shape), 1e12)
        filtered, var = atrous(illumination, known, guides, level, Settings(taps="5x5"))
        edge = 2 * 2**level
        inner = np.s_[0, edge:-edge, edge:-edge]
        factor = (h**2).sum() ** 2
        assert_allclose(var[inner], 1e12 * factor, rtol=1e-6)
        assert_allclose(luminance(filtered)[inner].var(), factor / 12, rtol=0.15)

    def test_misses_neither_give_nor_take(self, rng: np.random.Generator) -> None:
        frame = bumpy(rng, misses=0.3)
        miss = ~guides_of(frame).hit
        bright = replace(frame, color=np.where(miss[..., None], np.float32(1e6), frame.color))
        dull, glaring = (Reference(SHAPE).denoise(f) for f in (frame, bright))
        assert_allclose(dull[miss], frame.color[miss], rtol=1e-12)
        assert_allclose(glaring[miss], 1e6)
        assert_array_equal(dull[~miss], glaring[~miss])


class TestTaa:
    STILL = guides_of(wall())
    LONG = np.full(SHAPE, 100.0)

    def test_static_constant_is_untouched(self) -> None:
        reference = Reference(SHAPE, Settings(taa=True))
        for _ in range(4):
            out = reference.denoise(wall(color=(8.0, 0.5, 0.0)))
        assert_allclose(out, np.broadcast_to((8, 0.5, 0), out.shape), atol=1e-12)

    def test_blends_within_the_neighbourhood(self, rng: np.random.Generator) -> None:
        before, now = rng.random((2, *SHAPE, 3))
        _, history = taa(before, self.STILL, self.LONG, None, Settings())
        _, current = taa(now, self.STILL, self.LONG, None, Settings())
        _, result = taa(now, self.STILL, self.LONG, history, Settings(alpha_taa=0.25))
        patch = current[3:6, 4:7].reshape(9, 3)
        clamped = np.clip(history[4, 5], patch.min(axis=0), patch.max(axis=0))
        assert_allclose(result[4, 5], 0.75 * clamped + 0.25 * current[4, 5])

    def test_old_light_is_clamped_away(self) -> None:
        _, history = taa(np.full((*SHAPE, 3), 100.0), self.STILL, self.LONG, None, Settings())
        assert_allclose(taa(np.full((*SHAPE, 3), 0.5), self.STILL, self.LONG, history, Settings())[0], 0.5)

    @pytest.mark.parametrize(("shift", "known"), [(-0.5, True), (-0.51, False), (0.49, True), (0.5, False)])
    def test_history_ends_half_a_pixel_outside(self, shift: float, known: bool) -> None:
        edge = 0 if shift < 0 else -1
        image = np.ones((*SHAPE, 3))
        image[:, edge] = 0.5
        _, history = taa(np.ones((*SHAPE, 3)), self.STILL, self.LONG, None, Settings())
        out, _ = taa(
            image,
            replace(self.STILL, motion=self.STILL.motion + np.array((shift, 0, 0))),
            self.LONG,
            history,
            Settings(),
        )
        assert (out[0, edge] > 0.6).all() == known

    def test_what_was_uncovered_has_no_history(self, rng: np.random.Generator) -> None:
        before, now = rng.random((2, *SHAPE, 3))
        _, history = taa(before, self.STILL, self.LONG, None, Settings())
        assert_allclose(taa(now, self.STILL, np.ones(SHAPE), history, Settings())[0], now)

    def test_a_ramp_is_resampled_exactly(self) -> None:
        ramp = np.linspace(0.2, 0.6, SHAPE[1])[:, None] * np.ones((*SHAPE, 1))
        history = np.concatenate([ramp, 0 * ramp, 0 * ramp], axis=-1)
        x, y, weight = catmull_rom_taps(reprojected(np.full((*SHAPE, 3), 0.3)))
        rows, columns, _ = locate(x, y, SHAPE)
        moved = np.einsum("thw,thwc->hwc", weight, history[rows, columns])
        assert_allclose(weight.sum(axis=0), 1)
        inner = np.s_[:, 1:-3, 0]
        assert_allclose(moved[inner], history[inner] + 0.3 * 0.4 / (SHAPE[1] - 1))

    def test_a_pixel_beside_an_edge_moves_with_the_edge(self) -> None:
        depth, motion = np.full(SHAPE, 5.0), np.zeros((*SHAPE, 3))
        depth[:, 4:], motion[:, 4:, 0] = 2.0, 1.0
        depth[0], motion[0] = 0.0, 7.0
        motion = motion[foremost(replace(self.STILL, depth=depth))]
        assert_array_equal(motion[2:, :3, 0], 0)
        assert_array_equal(motion[2:, 3:, 0], 1)
        assert_array_equal(motion[0, :3, 0], 0)


class TestPipeline:
    def test_constant_light_stays_constant(self, rng: np.random.Generator) -> None:
        """On any surface, with any albedo and motion."""
        reference = Reference(SHAPE)
        for _ in range(4):
            albedo = np.maximum(rng.random((*SHAPE, 3)), 0.01).astype(np.float32)
            frame = bumpy(rng, albedo=albedo, color=4 * albedo)
            assert_allclose(reference.denoise(frame), frame.color, rtol=1e-6)

    @pytest.mark.parametrize("shape", [(1, 1), (1, 9), (9, 1), (3, 5), (17, 13)])
    def test_sizes(self, rng: np.random.Generator, shape: Shape) -> None:
        reference = Reference(shape, Settings(taa=True))
        for _ in range(3):
            out = reference.denoise(bumpy(rng, shape))
            assert out.shape == (*shape, 3)
            assert np.isfinite(out).all()

    @pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf, -1.0])
    @pytest.mark.parametrize(
        "field", ["color", "albedo", "normal", "depth", "motion", "emission", "direct", "indirect"]
    )
    def test_bad_input_does_no_harm(self, rng: np.random.Generator, field: str, bad: float) -> None:
        extra: dict[str, Any] = (
            {name: rng.random((*SHAPE, 3)) for name in ("direct", "indirect")} if field.endswith("direct") else {}
        )
        frame = bumpy(rng, emission=rng.random((*SHAPE, 3)), **extra)
        broken = replace(frame, **{field: getattr(frame, field).copy()})
        getattr(broken, field)[2:9, 3:8] = bad
        reference = Reference(SHAPE, Settings(taa=True))
        for f in (broken, frame, broken, broken):
            out = reference.denoise(f)
            assert np.isfinite(out).all()
            assert all(np.isfinite(stage).all() for stage in reference.stages.values())

    def test_colour_history_is_the_first_level(self, rng: np.random.Generator) -> None:
        reference = Reference(SHAPE)
        reference.denoise(bumpy(rng))
        assert reference.history is not None
        kept = reference.history.accumulated
        assert_array_equal(kept.illumination, reference.stages["level_1"])
        assert (kept.illumination != reference.stages["level_2"]).any()
        assert_array_equal(kept.variance, reference.stages["moment_variance"])

    def test_reset_forgets(self, rng: np.random.Generator) -> None:
        frames = [bumpy(rng) for _ in range(2)]
        reference = Reference(SHAPE, Settings(taa=True))
        first = [reference.denoise(frame) for frame in frames]
        reference.reset()
        assert_array_equal(reference.denoise(frames[0]), first[0])
        assert (reference.denoise(frames[1]) == first[1]).all()
        reference.reset()
        assert (reference.denoise(frames[1]) != first[1]).any()

    def run(self, frames: list[Frame]) -> Array:
        reference = Reference(frames[0].shape)
        return [reference.denoise(frame) for frame in frames][-1]

    def test_exposure_does_not_matter(self, rng: np.random.Generator) -> None:
        frames = [bumpy(rng) for _ in range(3)]
        bright = [replace(frame, color=frame.color * np.float64(1e3)) for frame in frames]
        assert_allclose(self.run(bright), 1e3 * self.run(frames), rtol=1e-7)

    def test_scene_scale_does_not_matter(self, rng: np.random.Generator) -> None:
        frames = [bumpy(rng) for _ in range(3)]
        scale = np.array((1, 1, 1e3))
        huge = [replace(f, depth=f.depth * np.float64(1e3), motion=f.motion * scale) for f in frames]
        assert_allclose(self.run(huge), self.run(frames), rtol=1e-9)

    def test_mirrored_frames_give_the_mirrored_image(self, rng: np.random.Generator) -> None:
        frames = [bumpy(rng) for _ in range(3)]
        flip = np.array((-1, 1, 1), np.float32)
        flipped = [Frame(**{name: value[:, ::-1] for name, value in f.present().items()}) for f in frames]
        mirrored = [replace(f, motion=f.motion * flip) for f in flipped]
        assert_allclose(self.run(mirrored)[:, ::-1], self.run(frames), rtol=1e-9)

    def test_two_equal_signals_behave_like_one(self, rng: np.random.Generator) -> None:
        single = [bumpy(rng) for _ in range(3)]
        double = [replace(frame, direct=frame.color, indirect=frame.color) for frame in single]
        assert_allclose(self.run(double), 2 * self.run(single), rtol=1e-12)

    def test_signals_do_not_mix(self, rng: np.random.Generator) -> None:
        direct, *others = rng.random((3, *SHAPE, 3)).astype(np.float32)
        scene = bumpy(rng)
        results = []
        for indirect in others:
            reference = Reference(SHAPE)
            reference.denoise(replace(scene, direct=direct, indirect=indirect))
            results.append(reference.stages["level_5"])
        assert_array_equal(results[0][0], results[1][0])
        assert (results[0][1] != results[1][1]).any()

    def test_noise_shrinks(self, rng: np.random.Generator) -> None:
        shape = (48, 48)
        reference = Reference(shape)
        for _ in range(4):
            noisy = wall(shape, color=rng.gamma(0.5, 2, (*shape, 1)) * np.ones(3))
            out = reference.denoise(noisy)
        assert np.std(out) < 0.1 * np.std(noisy.color)
        assert_allclose(out.mean(), 1, atol=0.1)
