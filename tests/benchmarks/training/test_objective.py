"""The compiled filter is the oracle's, and its gradient is what finite differences say."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("numba")

from benchmarks.training.objective import DECAY, Pixels, packed, unpacked, untrained
from benchmarks.training.samples import Sample
from svgf_cl import Lbf
from svgf_cl.filters.lbf import Network
from svgf_cl.oracle.lbf import filtered, parameters, statistics
from svgf_cl.oracle.temporal import demodulate
from tests.frames import FULL, bumpy, only


@pytest.fixture(scope="module")
def pixels() -> Pixels:
    """All pixels of two made-up samples."""
    return Pixels.of([sample(seed) for seed in (1, 2)])


def sample(seed: int) -> Sample:
    """A sample whose truth is twice the light."""
    light, guides = demodulate(only(bumpy(np.random.default_rng(seed), (14, 17)), FULL))
    noise = 0.1 * np.square(light[..., 1])
    seen = statistics(light, noise, np.full((14, 17), 3.0), guides)
    return Sample(light[0], 2 * light[0], noise[0], seen[0], guides)


def network(seed: int = 3) -> Network:
    """One whose parameters differ much from pixel to pixel."""
    some = untrained(seed)
    return replace(some, second=10 * some.second, second_bias=some.second_bias + 2)


def test_the_compiled_filter_is_the_oracles() -> None:
    one = sample(4)
    every = Pixels.of([one])
    chosen = parameters(one.seen, network())
    expected = filtered(one.light[None], one.noise[None], chosen[None], one.guides, Lbf())[0][one.guides.hit]
    scale = every.scale[:, None]
    error, _ = every.error(network())
    assert error == pytest.approx(np.mean(np.square((expected - every.truth) / scale)), rel=1e-4)


def test_the_gradient_is_that_of_finite_differences(pixels: Pixels) -> None:
    values = packed(network())
    _, gradient = pixels.objective(values)
    random = np.random.default_rng(7)
    for direction in random.standard_normal((4, len(values))):
        step = 2e-3 * direction
        ahead, behind = (pixels.objective(values + sign * step)[0] for sign in (1, -1))
        along = (ahead - behind) / 2
        assert along == pytest.approx(float(gradient @ step), rel=0.03, abs=1e-2 * np.linalg.norm(gradient * step))


def test_weights_are_kept_small(pixels: Pixels) -> None:
    values = packed(network())
    penalty = pixels.objective(values)[0] - pixels.error(unpacked(values))[0]
    assert penalty == pytest.approx(DECAY * np.mean(np.square(values)))


def test_packing_is_undone_by_unpacking() -> None:
    values = np.random.default_rng(1).standard_normal(len(packed(network())))
    np.testing.assert_array_equal(packed(unpacked(values)), values)


def test_a_draw_has_other_pixels_for_another_seed(pixels: Pixels) -> None:
    first, again, other = (pixels.some(20, seed) for seed in (1, 1, 2))
    np.testing.assert_array_equal(first.places, again.places)
    assert len(first.places) == 20
    assert not np.array_equal(first.places, other.places)
