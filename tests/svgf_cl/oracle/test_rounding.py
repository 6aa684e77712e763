"""An error counts against what there is, or against the picture's mean where there is nothing."""

from __future__ import annotations

import numpy as np
from numpy.testing import assert_allclose, assert_array_equal

from svgf_cl.oracle.accuracy import DECISION
from svgf_cl.oracle.rounding import SCALE_SHARE, largest_channel, relative_error


def test_error_is_relative_to_the_value_or_to_the_mean() -> None:
    expected = np.array([0.0, 1.0, 2.0, -1.0])
    scale = SCALE_SHARE * 1.0
    assert_allclose(relative_error(expected + 1e-6, expected), 1e-6 / (np.abs(expected) + scale))


def test_all_zero_is_right_or_wholly_wrong() -> None:
    assert relative_error(np.zeros(3), np.zeros(3)).max() == 0
    assert relative_error(np.ones(3), np.zeros(3)).min() >= DECISION


def test_a_colour_is_as_large_as_its_greatest_channel() -> None:
    assert_array_equal(largest_channel(np.array([[0.1, -3.0, 2.0], [0.0, 0.0, 0.5]])), [[3.0], [0.5]])
