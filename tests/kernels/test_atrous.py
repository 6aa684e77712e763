"""atrous.cl: noise goes, edges and constant light stay."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from numpy.lib.stride_tricks import sliding_window_view
from numpy.testing import assert_allclose

from svgf_cl import Denoiser, Settings
from tests.denoising import feed
from tests.frames import SHAPE, noise, wall

SPLINES = {"5x5": np.array((1 / 16, 1 / 4, 3 / 8, 1 / 4, 1 / 16)), "3x3": np.array((1 / 4, 1 / 2, 1 / 4))}
LEFT = np.arange(SHAPE[1]) < 17
LEVELS = range(1, 6)


def everywhere(left: Any, right: Any) -> np.ndarray:
    """One value or triple on the left of an edge, another on its right."""
    left, right = np.broadcast_arrays(left, right)
    return np.where(LEFT.reshape(-1, *[1] * left.ndim), left, right) * np.ones((SHAPE[0], 1, *[1] * left.ndim))


@pytest.mark.parametrize("color", [0.0, 1e-20, 0.5, 1e10])
def test_constant_image_stays_constant(color: float) -> None:
    _, den = feed(wall(color=color))
    for level in LEVELS:
        assert_allclose(den.stage(f"level_{level}"), np.float32(color), rtol=1e-6)


@pytest.mark.parametrize(("taps", "spline"), SPLINES.items())
def test_without_edges_a_level_is_the_spline(taps: str, spline: np.ndarray) -> None:
    picture = noise()
    _, den = feed(wall(color=picture), sigma_luminance=1000, taps=taps)
    count = len(spline)
    windows = sliding_window_view(picture, (count, count), axis=(0, 1))
    smooth = np.einsum("yxcij,i,j->yxc", windows, spline, spline)
    inside = slice(count // 2, -(count // 2))
    assert_allclose(den.stage("level_1")[0][inside, inside], smooth, rtol=2e-3)


def test_each_level_lowers_variance() -> None:
    _, den = feed(wall(color=noise()))
    means = [den.stage(name).mean() for name in ("variance", *(f"level_{level}_variance" for level in LEVELS))]
    assert all(after < before for before, after in pairwise(means))


def test_noise_goes() -> None:
    assert feed(wall(color=noise()))[0].std() < noise().std() / 10


@pytest.mark.parametrize(
    "edge",
    [
        {"normal": everywhere((0.0, 0.0, 1.0), (1.0, 0.0, 0.0))},
        {"depth": everywhere(4.0, 8.0)},
        {"depth": everywhere(4.0, np.inf)},
    ],
    ids=["normal", "depth", "miss"],
)
def test_no_light_crosses_an_edge(edge: dict[str, np.ndarray]) -> None:
    light = everywhere(1.0, 0.0)[..., None] * np.ones(3)
    assert_allclose(feed(wall(color=light, **edge))[0], light, rtol=1e-6, atol=1e-30)


def test_miss_is_left_as_it_is() -> None:
    sky = wall(color=noise(), depth=np.inf)
    assert_allclose(feed(sky)[0], sky.color, rtol=1e-5, atol=1e-7)  # green comes back from luminance


def test_scene_scale_does_not_matter() -> None:
    y, x = np.indices(SHAPE)
    slope = (4 + 0.05 * x + 0.02 * y).astype(np.float32)
    expected = feed(wall(color=noise(), depth=slope))[0]
    for scale in (1e-3, 1e3):
        assert_allclose(feed(wall(color=noise(), depth=scale * slope))[0], expected, rtol=1e-4)


def test_exposure_does_not_matter() -> None:
    expected = feed(wall(color=noise()))[0]
    for exposure in (1e-3, 1e3):
        assert_allclose(feed(wall(color=exposure * noise()))[0], exposure * expected, rtol=1e-4)


@pytest.mark.parametrize("taps", SPLINES)
@pytest.mark.parametrize("iterations", LEVELS)
def test_a_spot_spreads_as_far_as_the_levels_reach(iterations: int, taps: str) -> None:
    shape = (1, 200)
    spot = np.zeros((*shape, 3))
    spot[0, 100] = 1e10  # so bright that its faintest trace is no denormal number
    out, _ = feed(wall(shape, color=spot), iterations=iterations, sigma_luminance=1000, taps=taps)
    lit = np.flatnonzero(out[0, :, 0]) - 100
    reach = len(SPLINES[taps]) // 2 * (2**iterations - 1)
    assert (lit.min(), lit.max()) == (-reach, reach)


def test_border_of_misses_changes_nothing() -> None:
    inner = wall(color=noise())
    frame = {name: np.pad(value, [(20, 3), (40, 7), (0, 0)][: value.ndim]) for name, value in inner.present().items()}
    expected, out = feed(inner)[0], Denoiser(frame["depth"].shape, settings=Settings()).denoise(type(inner)(**frame))
    assert_allclose(out[20:-3, 40:-7], expected, rtol=1e-6)
