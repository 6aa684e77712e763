"""Properties of the oracle: what must hold whatever the kernels do (docs/algorithm.md, sections 1, 2, 5 and 6)."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from svgf_cl.filters import FILTERS, Kalman, Settings
from svgf_cl.filters.filter import Filter
from svgf_cl.frame import Frame, Shape
from svgf_cl.oracle import oracle_of
from svgf_cl.oracle.svgf import Oracle
from svgf_cl.oracle.taps import Array, luminance
from svgf_cl.oracle.temporal import (
    Accumulated,
    History,
    consistent,
    demodulate,
    foremost,
    modulate,
    taa,
    temporal,
)
from tests.svgf_cl.oracle.scenes import SHAPE, bumpy, guides_of, wall


def history_of(frame: Frame, mean: Array | float, var: Array | float = 0.0, length: float = 1.0) -> History:
    """Return a one-signal history of grey light whose luminance moments are given."""
    mean = np.broadcast_to(mean, (1, *frame.shape)).astype(np.float64)
    grey = np.repeat(mean[..., None], 3, axis=-1)
    past = Accumulated(grey, mean, np.broadcast_to(var, mean.shape), np.full(frame.shape, length))
    return History(guides_of(frame), past)


def accumulate(frame: Frame, history: History | None, *, alpha_moments: float = 0.2, **chosen: Any) -> Accumulated:
    """What a frame adds to a history."""
    return temporal(*demodulate(frame), history, Settings(**chosen), alpha_moments)


def lengths(*frames: Frame, **chosen: Any) -> Array:
    """History length after a sequence."""
    oracle = Oracle(frames[0].shape, Settings(iterations=1, **chosen))
    for frame in frames:
        oracle.denoise(frame)
    return oracle.stages["history_length"]


class TestDemodulate:
    def test_modulate_undoes_it(self, rng: np.random.Generator) -> None:
        emission = rng.random((*SHAPE, 3)).astype(np.float32)
        frame = bumpy(rng, emission=emission, color=emission + rng.random((*SHAPE, 3)))
        assert_allclose(modulate(*demodulate(frame)), frame.color, atol=1e-12)

    def test_light_on_black_survives(self) -> None:
        illumination, guides = demodulate(wall(color=0.25, albedo=0.0))
        assert_allclose(illumination, 0.25 / 0.02, rtol=1e-6)
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
        illumination, _ = demodulate(new)
        result = accumulate(new, history, alpha_moments=alpha)

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
        frame = bumpy(rng)
        illumination, guides = demodulate(frame)
        first = accumulate(frame, None)
        assert_array_equal(first.illumination, illumination)
        assert_array_equal(first.mean, luminance(illumination))
        assert_array_equal(first.variance, 0)
        assert_array_equal(first.length, guides.hit)

    def test_alpha_bounds_the_new_share_from_below(self) -> None:
        history = history_of(wall(), 1, 0.5, length=99.0)
        result = accumulate(wall(color=6), history, alpha_color=0.2, alpha_moments=0.4)
        assert_allclose(result.illumination, 1 + 0.2 * 5)
        assert_allclose(result.mean, 1 + 0.4 * 5)
        assert_allclose(result.variance, 0.6 * (0.5 + 0.4 * 25))

    def test_length_stops_at_1024(self) -> None:
        assert_array_equal(accumulate(wall(), history_of(wall(), 0.5, length=1024.0)).length, 1024)

    def test_one_pixel_pan_keeps_all_but_the_column_that_came_in(self) -> None:
        columns = np.arange(SHAPE[1])
        length = lengths(wall(id=columns + 1), wall(id=columns + 2, motion=(1, 0)))
        assert_array_equal(length[:, :-1], 2)
        assert_array_equal(length[:, -1], 1)

    def test_half_pixel_pan_interpolates(self, rng: np.random.Generator) -> None:
        mean = rng.random(SHAPE)
        result = accumulate(wall(motion=(-0.5, 0)), history_of(wall(), mean, length=3.0))
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
        oracle = Oracle(SHAPE, Settings())
        for frame in (wall(id=7, color=1), wall(id=7, color=1), wall(**{"id": 7, "color": 3} | change)):
            oracle.denoise(frame)
        assert_array_equal(oracle.stages["history_length"], 1)
        assert_allclose(oracle.stages["accumulated"], 3)
        assert_allclose(oracle.stages["mean"], 3)
        assert_array_equal(oracle.stages["moment_variance"], 0)

    def test_thin_geometry_is_found_beside_its_footprint(self) -> None:
        wire = np.where(np.arange(SHAPE[1]) == 6, 2, 1)
        motion = np.where(wire == 2, 1.0, 0.0)[None, :, None] * (1, 0)
        history = history_of(wall(id=wire), np.where(wire == 2, 9, 1), length=1.0)
        result = accumulate(wall(id=wire, motion=motion), history)
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


class TestTaa:
    STILL = guides_of(wall())
    LONG = np.full(SHAPE, 100.0)

    def test_static_constant_is_untouched(self) -> None:
        oracle = Oracle(SHAPE, Settings(taa=True))
        for _ in range(4):
            out = oracle.denoise(wall(color=(8.0, 0.5, 0.0)))
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

    def test_a_pixel_beside_an_edge_moves_with_the_edge(self) -> None:
        depth, motion = np.full(SHAPE, 5.0), np.zeros((*SHAPE, 3))
        depth[:, 4:], motion[:, 4:, 0] = 2.0, 1.0
        depth[0], motion[0] = 0.0, 7.0
        motion = motion[foremost(replace(self.STILL, depth=depth))]
        assert_array_equal(motion[2:, :3, 0], 0)
        assert_array_equal(motion[2:, 3:, 0], 1)
        assert_array_equal(motion[0, :3, 0], 0)


@pytest.mark.parametrize("kind", FILTERS.values(), ids=FILTERS)
class TestOracle:
    """A whole filter over a sequence: what holds of each."""

    def test_constant_light_stays_constant(self, kind: type[Filter], rng: np.random.Generator) -> None:
        """On any surface, with any albedo and motion."""
        oracle = oracle_of(kind(), SHAPE)
        for _ in range(4):
            albedo = np.maximum(rng.random((*SHAPE, 3)), 0.04).astype(np.float32)
            frame = bumpy(rng, albedo=albedo, color=4 * albedo)
            assert_allclose(oracle.denoise(frame), frame.color, rtol=1e-6)

    @pytest.mark.parametrize("shape", [(1, 1), (1, 9), (9, 1), (3, 5), (17, 13)])
    def test_sizes(self, kind: type[Filter], rng: np.random.Generator, shape: Shape) -> None:
        oracle = oracle_of(kind(taa=True), shape)
        for _ in range(3):
            out = oracle.denoise(bumpy(rng, shape))
            assert out.shape == (*shape, 3)
            assert np.isfinite(out).all()

    @pytest.mark.parametrize(
        "field", ["color", "albedo", "normal", "depth", "motion", "emission", "direct", "indirect"]
    )
    def test_bad_input_does_no_harm(self, kind: type[Filter], rng: np.random.Generator, field: str) -> None:
        """Every kind of bad value has rows of its own."""
        extra: dict[str, Any] = (
            {name: rng.random((*SHAPE, 3)) for name in ("direct", "indirect")} if field.endswith("direct") else {}
        )
        frame = bumpy(rng, emission=rng.random((*SHAPE, 3)), **extra)
        broken = replace(frame, **{field: getattr(frame, field).copy()})
        for row, bad in zip((1, 4, 7, 10), (np.nan, np.inf, -np.inf, -1.0), strict=True):
            getattr(broken, field)[row : row + 2, 3:8] = bad
        oracle = oracle_of(kind(taa=True), SHAPE)
        for f in (broken, frame, broken, broken):
            out = oracle.denoise(f)
            assert np.isfinite(out).all()
            assert all(np.isfinite(stage).all() for stage in oracle.stages.values())

    def test_reset_forgets(self, kind: type[Filter], rng: np.random.Generator) -> None:
        frames = [bumpy(rng) for _ in range(2)]
        oracle = oracle_of(kind(taa=True), SHAPE)
        first = [oracle.denoise(frame) for frame in frames]
        oracle.reset()
        assert_array_equal(oracle.denoise(frames[0]), first[0])
        assert (oracle.denoise(frames[1]) == first[1]).all()
        oracle.reset()
        assert (oracle.denoise(frames[1]) != first[1]).any()

    def run(self, kind: type[Filter], frames: list[Frame]) -> Array:
        oracle = oracle_of(kind(), frames[0].shape)
        return [oracle.denoise(frame) for frame in frames][-1]

    def test_scene_scale_does_not_matter(self, kind: type[Filter], rng: np.random.Generator) -> None:
        frames = [bumpy(rng) for _ in range(3)]
        scale = np.array((1, 1, 1e3))
        huge = [replace(f, depth=f.depth * np.float64(1e3), motion=f.motion * scale) for f in frames]
        assert_allclose(self.run(kind, huge), self.run(kind, frames), rtol=1e-9)

    def test_mirrored_frames_give_the_mirrored_image(self, kind: type[Filter], rng: np.random.Generator) -> None:
        if kind is Kalman:
            pytest.skip("its blocks of 2x2 pixels begin on the left: mirrored, they hold other pixels")
        frames = [bumpy(rng) for _ in range(3)]
        flip = np.array((-1, 1, 1), np.float32)
        flipped = [Frame(**{name: value[:, ::-1] for name, value in f.present().items()}) for f in frames]
        mirrored = [replace(f, motion=f.motion * flip) for f in flipped]
        assert_allclose(self.run(kind, mirrored)[:, ::-1], self.run(kind, frames), rtol=1e-9)

    def test_two_equal_signals_behave_like_one(self, kind: type[Filter], rng: np.random.Generator) -> None:
        single = [bumpy(rng) for _ in range(3)]
        double = [replace(frame, direct=frame.color, indirect=frame.color) for frame in single]
        assert_allclose(self.run(kind, double), 2 * self.run(kind, single), rtol=1e-12)

    def test_signals_do_not_mix(self, kind: type[Filter], rng: np.random.Generator) -> None:
        direct, *others = rng.random((3, *SHAPE, 3)).astype(np.float32)
        scene = bumpy(rng)
        results = []
        for indirect in others:
            oracle = oracle_of(kind(), SHAPE)
            for light in (1.0, 0.5):  # twice, as a variance over time wants
                oracle.denoise(replace(scene, direct=light * direct, indirect=light * indirect))
            results.append(list(oracle.stages.values())[-2:])  # what was made last
        for first, second in zip(*results, strict=True):
            assert_array_equal(first[0], second[0])
            assert (first[1] != second[1]).any()
