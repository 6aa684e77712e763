"""bilateral.cl, select.cl and network.cl: SBF's scales and choice, LBF's parameters and window."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from svgf_cl import Denoiser, Lbf, Sbf
from svgf_cl.filters.bilateral import BilateralFilter
from svgf_cl.filters.lbf import INPUTS, OUTPUTS
from svgf_cl.filters.sbf import SIGMAS, WINDOW, gaussian
from svgf_cl.oracle.lbf import statistics
from svgf_cl.oracle.temporal import demodulate
from tests import denoising
from tests.frames import FULL, SHAPE, bumpy_sequence, noise, wall
from tests.oracle import error_to_oracle

LEFT = (np.arange(SHAPE[1]) < SHAPE[1] // 2)[:, None]
SCALES = range(1, len(SIGMAS) + 1)

feed = partial(denoising.feed, kind=Sbf)
BUMPY = partial(bumpy_sequence, FULL, count=2)
either = pytest.mark.parametrize("kind", [Sbf, Lbf])


# Root-mean-square error over all pixels, relative to the picture's mean; about three times what was measured.
HALVES = {"half_guides": True, "half_history": True}
BOUNDS = [
    (Sbf, HALVES, 2e-2),
    (Sbf, {"precision": "fast"}, 2e-2),
    (Lbf, HALVES, 1e-2),
    (Lbf, {"precision": "fast"}, 2e-2),
]


@pytest.mark.parametrize(("kind", "choice", "bound"), BOUNDS)
def test_error_to_the_oracle_of_what_saves_time_or_memory(
    kind: type[BilateralFilter], choice: dict[str, Any], bound: float
) -> None:
    assert error_to_oracle(BUMPY, kind(), **choice) <= bound


@either
@pytest.mark.parametrize("color", [0.0, 1e-20, 0.5, 1e10])
def test_constant_image_stays_constant(kind: type[BilateralFilter], color: float) -> None:
    assert_allclose(feed(wall(color=color), kind=kind)[0], np.float32(color), rtol=1e-5)


@either
@pytest.mark.parametrize(
    "edge",
    [
        {"normal": np.where(LEFT, (0.0, 0.0, 1.0), (1.0, 0.0, 0.0)) * np.ones((SHAPE[0], 1, 1))},
        {"depth": np.where(LEFT[:, 0], 4.0, 8.0)},
        {"depth": np.where(LEFT[:, 0], 4.0, np.inf)},
        {"albedo": np.where(LEFT, 0.9, 0.05) * np.ones((*SHAPE, 3))},
    ],
    ids=["normal", "depth", "miss", "albedo"],
)
def test_no_light_crosses_an_edge_of_surfaces(kind: type[BilateralFilter], edge: dict[str, np.ndarray]) -> None:
    light = np.where(LEFT, 1.0, 0.0) * np.ones((*SHAPE, 3))
    assert_allclose(feed(wall(color=light, **edge), kind=kind)[0], light, rtol=1e-5, atol=1e-6)


@either
@pytest.mark.parametrize("near", [1e-15, 4.0, 1e19])
def test_a_miss_keeps_its_light(kind: type[BilateralFilter], near: float) -> None:
    depth = np.where(noise()[..., 0] < 0.3, np.inf, near)
    out, _ = feed(wall(color=noise(), depth=depth), kind=kind)
    missed = np.isinf(depth)
    assert_allclose(out[missed], noise()[missed], rtol=1e-5)


@either
@pytest.mark.parametrize("unit", [2.0**-60, 2.0**60])
def test_any_unit_of_length_gives_the_same_picture(kind: type[BilateralFilter], unit: float) -> None:
    """Even one in which the square of a difference of depth is no float."""
    rng = np.random.default_rng(3)
    depth = 16 * rng.uniform(0.5, 2.0, SHAPE)
    usual, other = (wall(color=noise(), depth=scale * depth) for scale in (1.0, unit))
    assert_allclose(feed(other, kind=kind)[0], feed(usual, kind=kind)[0], rtol=1e-5)


def test_a_scale_on_a_wall_is_a_gaussian_of_its_width() -> None:
    """Of a single bright pixel in the middle, farther from the border than any window reaches."""
    shape = (4 * WINDOW + 3, 4 * WINDOW + 5)
    dot = np.zeros((*shape, 3))
    middle = shape[0] // 2, shape[1] // 2
    dot[middle] = 1.0
    _, den = feed(wall(shape, color=dot))
    for scale, row in zip(SCALES, gaussian().astype(np.float64), strict=True):
        reach = int(2 * SIGMAS[scale - 1])
        line = np.concatenate((row[reach:0:-1], row[: reach + 1]))
        expected = np.zeros(shape)
        inside = tuple(slice(centre - reach, centre + reach + 1) for centre in middle)
        expected[inside] = np.outer(line, line) / line.sum() ** 2
        assert_allclose(
            den.stage(f"scale_{scale}")[0, inside[0], middle[1], 0], expected[inside[0], middle[1]], rtol=1e-4
        )


def test_even_light_takes_a_wide_scale_and_a_bright_dot_the_narrowest() -> None:
    """The risk of noise falls with the number of taps; that of a dot, brighter than all noise, grows."""
    light = np.ones((*SHAPE, 3))
    middle = SHAPE[0] // 2, SHAPE[1] // 2
    dot = light.copy()
    dot[middle] = 1e3
    frames = [wall(color=light + 0.2 * noise(seed)) for seed in range(1, 6)]
    chosen = scale_chosen(feed(*frames)[1])
    assert np.mean(chosen >= 2) > 0.75
    _, den = feed(*[wall(color=dot + 0.2 * noise(seed)) for seed in range(1, 6)])
    assert scale_chosen(den)[middle] == 1


def scale_chosen(den: Denoiser) -> np.ndarray:
    """Number of the scale that each pixel shows, (H, W)."""
    shown = den.stage("filtered")[0]
    off = [np.abs(den.stage(f"scale_{scale}")[0] - shown).max(axis=-1) for scale in SCALES]
    assert_array_equal(np.min(off, axis=0), 0)
    chosen: np.ndarray = 1 + np.argmin(off, axis=0)
    return chosen


def test_risk_estimates_the_squared_error() -> None:
    """Stein's estimate less the noise that all scales share, on average over a wall whose true light is known."""
    truth = np.broadcast_to(1.0 + 0.5 * np.sin(0.6 * np.arange(SHAPE[1]))[:, None], (*SHAPE, 3))
    spread = 0.3
    random = np.random.default_rng(5)
    frames = [wall(color=truth + spread * random.standard_normal((*SHAPE, 1))) for _ in range(30)]
    _, den = feed(*frames, alpha_color=1e-3)
    noise_of_mean = spread**2 / len(frames)
    for scale in SCALES:
        error = np.mean(np.square(den.stage(f"scale_{scale}")[0] - truth))
        estimate = np.mean(den.stage(f"risk_{scale}")[0]) - noise_of_mean
        assert abs(estimate - error) < 0.15 * error + 0.3 * noise_of_mean


@pytest.mark.parametrize("exposure", [2.0**-8, 2.0**8])
def test_statistics_do_not_depend_on_exposure_or_scale(exposure: float) -> None:
    frame = bumpy_sequence(("color",), count=1)[0]
    other = wall(**frame.present() | {"color": exposure * frame.color, "depth": exposure * frame.depth})
    assert_allclose(seen(other), seen(frame), rtol=1e-4, atol=1e-6)


def seen(frame: Any) -> np.ndarray:
    """Statistics of a first frame whose noise is a tenth of its light."""
    light, guides = demodulate(frame)
    return statistics(light, 0.01 * np.square(light[..., 1]), np.ones(SHAPE), guides)


def test_statistics_are_bounded_and_as_many_as_the_network_takes() -> None:
    values = seen(bumpy_sequence(FULL, count=1)[0])
    assert values.shape == (1, *SHAPE, INPUTS)
    assert np.abs(values).max() <= 1


def test_parameters_are_powers_of_two_where_something_was_hit() -> None:
    _, den = feed(*bumpy_sequence(FULL, count=2), kind=Lbf)
    parameters, hit = den.stage("parameters"), den.stage("depth") > 0
    assert parameters.shape == (1, *SHAPE, OUTPUTS)
    assert (parameters[0, hit] > 0).all()
    assert (parameters[0, ~hit] == 0).all()
