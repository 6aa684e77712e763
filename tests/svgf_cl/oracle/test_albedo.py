"""What light is divided by, and which albedos are alike."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from svgf_cl.oracle.albedo import albedo_codes, alike, divisor


@pytest.mark.parametrize(
    ("albedo", "expected"),
    [
        ((0.0, 0.0, 0.0), (0.02, 0.02, 0.02)),
        ((1.0, 0.0, 0.0), (1.0, 0.04, 0.04)),
        ((0.3, 0.1, 0.0), (0.3, 0.1, 0.02)),
        ((0.8, 0.8, 0.8), (0.8, 0.8, 0.8)),
    ],
)
def test_no_channel_is_far_below_the_others(albedo: tuple[float, ...], expected: tuple[float, ...]) -> None:
    assert_allclose(divisor(np.array(albedo)), expected)


def test_the_channel_that_differs_most_decides() -> None:
    grey = np.full(3, 0.4)
    for channel in range(3):
        darker = grey.copy()
        darker[channel] = 0.1  # less than two octaves below, with what is added to both
        codes, others = albedo_codes(grey), albedo_codes(darker)
        assert alike(codes, others, 2.0)
        assert alike(others, codes, 2.0)
        assert not alike(codes, others, 1.75)
        assert not alike(others, codes, 1.75)


def test_at_eight_octaves_all_are_alike() -> None:
    assert alike(albedo_codes(np.zeros(3)), albedo_codes(np.ones(3)), 8.0)
