"""Noise leaves the guides, and nothing else does."""

from __future__ import annotations

import warnings
from dataclasses import replace

import numpy as np
import pytest

from svgf_cl import Frame
from svgf_cl.check.noise import has_noisy_depth
from svgf_cl.io.shot import Light
from svgf_cl.io.synthetic import room_frame
from svgf_cl.prefilter import BLACK, Prefilter, extremes

SHAPE = (24, 40)
FRAMES = 6


def floor(shape: tuple[int, int] = SHAPE) -> Frame:
    """A plane that recedes upward, as a camera above it sees it: its depth does not rise evenly, 1 / depth does."""
    rows = np.arange(1.0, shape[0] + 1)[:, None] + 0.05 * np.arange(shape[1])
    normal = np.zeros((*shape, 3), np.float32)
    normal[..., 1] = 1.0
    zero = np.zeros((*shape, 2), np.float32)
    return Frame(color=normal, normal=normal, depth=(100.0 / rows).astype(np.float32), motion=zero)


def noise(seed: int, scale: float, *components: int) -> np.ndarray:
    return np.random.default_rng(seed).uniform(-scale, scale, (*SHAPE, *components)).astype(np.float32)


def filtered(frames: list[Frame], **chosen: bool) -> Frame:
    """The last one of a sequence with better guides."""
    prefilter = Prefilter(SHAPE, **{"is_noisy": True, **chosen})
    return [prefilter.frame(frame) for frame in frames][-1]


def spread(values: np.ndarray) -> float:
    return float(np.std(np.diff(values, axis=1)))


@pytest.mark.parametrize("shape", [SHAPE, (1, 1), (5, 2), (2, 5)])
def test_planes_at_any_slant_and_of_any_size_are_not_noisy(shape: tuple[int, int]) -> None:
    assert not has_noisy_depth(floor(shape))


def test_steps_between_surfaces_are_not_noise() -> None:
    frame = floor()
    frame.depth[:, ::8] *= 0.5
    assert not has_noisy_depth(frame)


def test_depth_of_random_places_in_the_lens_is_noisy() -> None:
    frame = floor()
    assert has_noisy_depth(replace(frame, depth=frame.depth * (1 + noise(1, 0.01))))


@pytest.mark.parametrize("hole", [0.0, np.inf, np.nan])
def test_rays_that_missed_among_others_that_hit_are_noise(hole: float) -> None:
    frame = floor()
    frame.depth[::4, ::4] = hole
    frame.normal[::4, ::4] = 0.0
    assert has_noisy_depth(frame)
    frame.depth[:], frame.normal[:] = hole, 0.0
    assert not has_noisy_depth(frame)


def test_infinite_normals_are_no_warning() -> None:
    frame = floor()
    frame.normal[3:6] = np.inf
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert not has_noisy_depth(frame)


def test_noise_leaves_albedo_and_depth_and_normals_stay() -> None:
    clean = floor()
    frames = [
        replace(clean, depth=clean.depth * (1 + noise(seed, 0.05)), albedo=0.5 + noise(seed, 0.2, 3))
        for seed in range(FRAMES)
    ]
    last = filtered(frames)
    assert np.std(last.albedo) < 0.5 * np.std(frames[-1].albedo)
    assert spread(1 / last.depth) < 0.7 * spread(1 / frames[-1].depth)
    np.testing.assert_array_equal(last.normal, clean.normal)


def test_without_noise_in_depth_it_is_albedo_alone() -> None:
    frame = replace(floor(), albedo=0.5 + noise(1, 0.2, 3))
    last = filtered([frame], is_noisy=False)
    assert last.depth is frame.depth
    assert last.normal is frame.normal
    assert (last.albedo != frame.albedo).any()


def test_black_albedo_of_lamps_stays_black() -> None:
    albedo = 0.5 + noise(1, 0.2, 3)
    albedo[8:12, 8:12] = BLACK / 2
    last = filtered([replace(floor(), albedo=albedo)] * FRAMES)
    np.testing.assert_array_equal(last.albedo[8:12, 8:12], albedo[8:12, 8:12])


def test_a_hole_in_a_surface_is_filled_and_the_sky_stays() -> None:
    frames = []
    for seed in range(FRAMES):
        frame = floor()
        holes = np.random.default_rng(seed).random(SHAPE) < 0.2
        holes[:8] = True
        frame.normal[holes], frame.depth[holes] = 0.0, np.inf
        frames.append(frame)
    last = filtered(frames)
    was, here = ~frames[-1].normal.any(axis=-1), last.normal.any(axis=-1)
    assert here[9:].all()
    np.testing.assert_allclose(np.linalg.norm(last.normal[9:], axis=-1), 1.0, rtol=1e-5)
    assert np.isfinite(last.depth[9:][was[9:]]).mean() > 0.9
    assert not here[:6].any()
    assert np.isinf(last.depth[:6]).all()


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_a_value_that_is_not_finite_leaves_its_neighbours_usable(value: float) -> None:
    frame = replace(floor(), albedo=0.5 + noise(1, 0.2, 3))
    frame.albedo[10, 10], frame.depth[15, 15] = value, np.nan
    last = filtered([frame] * 2)
    around = np.ones(SHAPE, bool)
    around[10, 10] = around[15, 15] = False
    assert np.isfinite(last.albedo[around]).all()
    assert (last.depth[around] > 0).all()


def factor_light(factor: np.ndarray, **changes: object) -> Light:
    return Light(("l.R",), np.ones((*SHAPE, 3), np.float32), factor, ("f.R",), **changes)  # type: ignore[arg-type]


@pytest.mark.parametrize(("is_noisy", "is_followed"), [(False, True), (True, False)])
def test_factors_stay_where_depth_is_clean_or_motion_unknown(is_noisy: bool, is_followed: bool) -> None:
    lights = (factor_light(0.5 + noise(1, 0.2, 3), filtered=False),)
    prefilter = Prefilter(SHAPE, is_noisy=is_noisy, is_followed=is_followed)
    assert prefilter.lights(floor(), lights) == lights


def test_a_factor_that_two_lights_share_is_filtered_once_for_both() -> None:
    prefilter = Prefilter(SHAPE, is_noisy=True)
    for seed in range(FRAMES):
        factor = 0.5 + noise(seed, 0.2, 3)
        one, other = prefilter.lights(floor(), (factor_light(factor), factor_light(factor, filtered=False)))
    assert one.factor is other.factor
    assert np.std(one.factor) < 0.5 * np.std(factor)
    assert other.filtered


def test_a_cut_forgets_the_past() -> None:
    frames = [replace(room_frame(SHAPE, at, at - 1), albedo=0.5 + noise(at, 0.2, 3)) for at in range(3)]
    prefilter = Prefilter(SHAPE, is_noisy=True)
    for frame in frames[:2]:
        prefilter.frame(frame)
    prefilter.reset()
    np.testing.assert_array_equal(prefilter.frame(frames[2]).albedo, filtered(frames[2:]).albedo)


def test_extremes_are_those_of_the_neighbours() -> None:
    values = np.zeros((4, 5, 1), np.float32)
    values[1, 1], values[3, 4] = 1.0, np.nan
    least, greatest = extremes(values)
    np.testing.assert_array_equal(greatest[..., 0], np.pad(np.ones((3, 3)), ((0, 1), (0, 2))))
    np.testing.assert_array_equal(least, 0.0)
