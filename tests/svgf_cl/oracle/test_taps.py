"""The oracle's array helpers."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from svgf_cl.oracle.taps import depth_gradient

SHAPE = (12, 14)


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
