"""The oracle's array helpers."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from svgf_cl.oracle.taps import catmull_rom_taps, depth_gradient, locate, reprojected, smoothed
from tests.svgf_cl.oracle.scenes import SHAPE, bumpy, guides_of


class TestGradient:
    def test_plane(self) -> None:
        y, x = np.indices(SHAPE)
        gradient = depth_gradient(5 + 0.25 * x - 0.125 * y)
        assert_array_equal(gradient, np.broadcast_to((0.25, -0.125), gradient.shape))

    @pytest.mark.parametrize(
        ("depth", "expected"),
        [
            ((1, 2, 9, 10), (1, 1, 1, 1)),  # refuses the edge between 2 and 9
            ((1, 3, 1, 0), (2, 0, -2, 0)),  # neither way from a peak; no difference to a miss
            ((4, 3, 1, 5), (-1, -1, 0, 4)),
            ((0, 5, 0, 4), (0, 0, 0, 0)),  # alone
        ],
    )
    def test_one_row(self, depth: tuple[float, ...], expected: tuple[float, ...]) -> None:
        gradient = depth_gradient(np.array([depth], np.float64))
        assert_array_equal(gradient[0, :, 0], expected)
        assert_array_equal(gradient[..., 1], 0)


def test_smoothed_variance_is_that_of_hits(rng: np.random.Generator) -> None:
    hit = guides_of(bumpy(rng, misses=0.3)).hit
    assert_allclose(smoothed(np.where(hit, 2.0, 100.0)[None], hit)[0][hit], 2)


def test_a_ramp_is_resampled_exactly() -> None:
    ramp = np.linspace(0.2, 0.6, SHAPE[1])[:, None] * np.ones((*SHAPE, 1))
    history = np.concatenate([ramp, 0 * ramp, 0 * ramp], axis=-1)
    x, y, weight = catmull_rom_taps(reprojected(np.full((*SHAPE, 3), 0.3)))
    rows, columns, _ = locate(x, y, SHAPE)
    moved = np.einsum("thw,thwc->hwc", weight, history[rows, columns])
    assert_allclose(weight.sum(axis=0), 1)
    inner = np.s_[:, 1:-3, 0]
    assert_allclose(moved[inner], history[inner] + 0.3 * 0.4 / (SHAPE[1] - 1))
