"""EAW on a device, whose levels are atrous.cl without a variance: noise goes, edges in light stay, history is raw."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
import pytest
from numpy.lib.stride_tricks import sliding_window_view
from numpy.testing import assert_allclose, assert_array_equal

from svgf_cl import Denoiser, Eaw
from svgf_cl.oracle.spatial import surface_weight
from svgf_cl.oracle.taps import depth_gradient, shifted, square
from svgf_cl.oracle.temporal import demodulate
from tests import denoising
from tests.frames import SHAPE, SPLIT, bumpy, bumpy_sequence, noise, only, wall
from tests.oracle import TOLERANCES, error_to_oracle

SPLINES = {"5x5": np.array((1 / 16, 1 / 4, 3 / 8, 1 / 4, 1 / 16)), "3x3": np.array((1 / 4, 1 / 2, 1 / 4))}
LEFT = (np.arange(SHAPE[1]) < 17)[:, None]
LEVELS = range(1, 6)
ALL = 1e6  # the greatest sigma_color: any light is like any other

feed = partial(denoising.feed, kind=Eaw)
BUMPY = partial(bumpy_sequence, SPLIT)


# Root-mean-square error over all pixels, relative to the picture's mean; about three times what was measured.
HALVES = {"half_guides": True, "half_history": True}
FAST = {"precision": "fast"}
BOUNDS = [(HALVES, 3e-3), (FAST, 7e-3), (HALVES | FAST, 8e-3)]


@pytest.mark.parametrize(("choice", "bound"), BOUNDS, ids=["halves", "fast", "halves and fast"])
def test_error_to_the_oracle_of_what_saves_time_or_memory(choice: dict[str, Any], bound: float) -> None:
    assert error_to_oracle(BUMPY, Eaw(sigma_color=4), **choice) <= bound


@pytest.mark.parametrize("color", [0.0, 1e-20, 0.5, 1e10])
def test_constant_image_stays_constant(color: float) -> None:
    _, den = feed(wall(color=color))
    for level in LEVELS:
        assert_allclose(den.stage(f"level_{level}"), np.float32(color), rtol=1e-6)


@pytest.mark.parametrize("taps", SPLINES)
def test_an_edge_in_light_far_above_the_tolerance_stays_as_it_is(taps: str) -> None:
    """To rounding, in every channel apart; the sum of squares is 100 times what the first level tolerates."""
    light = np.where(LEFT, (1.0, 0.5, 0.25), (0.0, 0.5, 0.25)) * np.ones((SHAPE[0], 1, 1))
    assert_allclose(feed(wall(color=light), sigma_color=0.1, taps=taps)[0], light, rtol=1e-6, atol=1e-30)


def test_an_edge_in_light_far_below_the_tolerance_goes() -> None:
    light = np.where(LEFT, 1.0, 0.0) * np.ones((*SHAPE, 3))
    out, _ = feed(wall(color=light), sigma_color=ALL)
    assert np.abs(np.diff(out, axis=1)).max() < 0.15


@pytest.mark.parametrize(
    ("edge", "faintest"),
    [
        ({"normal": np.where(LEFT, (0.0, 0.0, 1.0), (1.0, 0.0, 0.0)) * np.ones((SHAPE[0], 1, 1))}, 1e-30),
        ({"depth": np.where(LEFT[:, 0], 4.0, 8.0)}, np.exp(-4 / (16 * 8e-3))),  # of the last level, seen from afar
        ({"depth": np.where(LEFT[:, 0], 4.0, np.inf)}, 1e-30),
    ],
    ids=["normal", "depth", "miss"],
)
def test_no_light_crosses_an_edge_of_surfaces(edge: dict[str, np.ndarray], faintest: float) -> None:
    """However much difference in light is tolerated."""
    light = np.where(LEFT, 1.0, 0.0) * np.ones((*SHAPE, 3))
    assert_allclose(feed(wall(color=light, **edge), sigma_color=ALL)[0], light, rtol=1e-6, atol=faintest)


def test_noise_goes_where_it_is_tolerated() -> None:
    assert feed(wall(color=noise()), sigma_color=10)[0].std() < noise().std() / 10


def test_noise_stays_where_it_is_not() -> None:
    assert_allclose(feed(wall(color=noise()), sigma_color=1e-6)[0], noise(), rtol=1e-5, atol=1e-6)


@pytest.mark.parametrize("level", LEVELS)
def test_tolerance_halves_with_every_level(level: int) -> None:
    """Two pixels as far apart as this level's taps, and nothing between them: no other level finds a neighbour."""
    step, dim = 2 ** (level - 1), 0.0625
    seen = np.isin(np.arange(step + 1), (0, step))[None]
    picture = np.where(np.arange(step + 1) == step, dim, 0.0)[None, :, None]
    _, den = feed(
        wall((1, step + 1), color=picture, depth=np.where(seen, 4.0, np.inf)), iterations=level, sigma_color=1
    )
    w = 1 / 8 * np.exp(-3 * (dim * step) ** 2)
    assert_allclose(den.stage(f"level_{level}")[0, 0, 0], dim * w / (1 / 4 + w), rtol=1e-4)


@pytest.mark.parametrize(("taps", "spline"), SPLINES.items())
def test_tolerating_all_on_a_wall_a_level_is_the_spline(taps: str, spline: np.ndarray) -> None:
    picture = noise()
    _, den = feed(wall(color=picture), sigma_color=ALL, taps=taps)
    count = len(spline)
    windows = sliding_window_view(picture, (count, count), axis=(0, 1))
    smooth = np.einsum("yxcij,i,j->yxc", windows, spline, spline)
    inside = slice(count // 2, -(count // 2))
    assert_allclose(den.stage("level_1")[0][inside, inside], smooth, rtol=2e-5)


@pytest.mark.parametrize(("taps", "spline"), SPLINES.items())
def test_tolerating_all_it_is_a_blur_weighted_by_surface(taps: str, spline: np.ndarray) -> None:
    frame, settings = only(bumpy(np.random.default_rng(4)), ("color",)), Eaw(sigma_color=ALL, taps=taps)
    den = Denoiser(SHAPE, settings=settings, keep_stages=True)
    den.denoise(frame)
    light, guides = demodulate(frame)
    gradient = depth_gradient(guides.depth)
    color, total = 0.0, 0.0
    for dx, dy in square(settings.radius):
        y, x, _ = shifted((dx, dy), SHAPE)
        h = spline[dx + settings.radius] * spline[dy + settings.radius]
        w = (h * surface_weight(guides, gradient, (dx, dy), 1, settings))[..., None]
        color, total = color + w * light[0, y, x], total + w
    expected = np.where(guides.hit[..., None], color / np.where(total > 0, total, 1), light[0])
    off = np.abs(den.stage("level_1")[0] - expected)
    assert (off <= TOLERANCES["level"] * expected.max(axis=-1, keepdims=True)).all()


@pytest.mark.parametrize("exposure", [2.0**-8, 2.0**8])
def test_light_and_tolerance_scaled_together_scale_the_picture(exposure: float) -> None:
    frames = bumpy_sequence(("color",), count=3)
    brighter = [wall(**frame.present() | {"color": exposure * frame.color}) for frame in frames]
    expected, got = feed(*frames, sigma_color=1)[0], feed(*brighter, sigma_color=exposure)[0]
    assert_array_equal(got, np.float32(exposure) * expected)


def test_miss_is_left_as_it_is() -> None:
    sky = wall(color=noise(), depth=np.inf)
    assert_allclose(feed(sky, sigma_color=ALL)[0], sky.color, rtol=1e-5, atol=1e-7)  # green comes back from luminance


@pytest.mark.parametrize("fields", [("color",), SPLIT], ids=["one signal", "two signals"])
def test_history_is_the_unfiltered_accumulation(fields: tuple[str, ...]) -> None:
    """Light of a static scene is the running mean of what came in, though every picture was filtered meanwhile."""
    rng = np.random.default_rng(1)
    still = {"normal": wall().normal, "depth": wall().depth, "motion": 0.0 * wall().motion, "id": 1}
    frames = [only(wall(**bumpy(rng).present() | still), fields) for _ in range(12)]
    den = Denoiser(SHAPE, settings=Eaw(alpha_color=0), keep_stages=True)
    seen = []
    for number, frame in enumerate(frames, start=1):
        den.denoise(frame)
        seen.append(den.stage("demodulated").astype(np.float64))
        assert_array_equal(den.stage("history_length"), number)
        mean = np.mean(seen, axis=0)
        off = np.abs(den.stage("accumulated") - mean)
        assert (off <= 1e-6 * mean.max(axis=-1, keepdims=True) + 1e-6 * mean.mean()).all()
    assert np.abs(den.stage("level_1") - den.stage("accumulated")).max() > 0.01


def test_history_forgets_by_alpha_color() -> None:
    """The moments too, as they have no alpha of their own."""
    _, den = feed(*[wall(color=value) for value in (1.0, 2.0, 4.0)], alpha_color=0.75)
    expected = 0.25 * (0.25 * 1 + 0.75 * 2) + 0.75 * 4
    assert_allclose(den.stage("accumulated"), expected, rtol=1e-6)
    assert_allclose(den.stage("mean"), expected, rtol=1e-6)
