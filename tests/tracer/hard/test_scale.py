"""The unit of length does not matter: millimetres, metres and kilometres give the same picture."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from svgf_cl import Frame
from tests.hard.variants import Variant, on
from tests.tracer.frames import traced_sequence

# Depth enters weights and TAA's choice of the foremost; what is kept in 16 bits has no unit of length.
variants = on("precise", "precise, two signals, TAA", "fast")

# A depth in another unit is rounded otherwise, by 2^-24, and edges are told by 1e-3 of it or less. Three times what was
# measured, beside what rounding of the light adds.
CHANGE = 2e-4


def scaled(frame: Frame, scale: float) -> Frame:
    """The same picture of a scene that is so many times as large."""
    return replace(frame, depth=frame.depth * np.float64(scale), motion=frame.motion * np.array((1, 1, scale)))


def pictures(variant: Variant, scale: float) -> np.ndarray:
    frames = traced_sequence(variant.fields)
    return np.stack(list(variant.pictures([scaled(frame, scale) for frame in frames], frames[0].shape)))


@pytest.mark.parametrize("scale", [2.0**-20, 2.0**30])
@variants
def test_powers_of_two_change_no_bit(variant: Variant, scale: float) -> None:
    assert_array_equal(pictures(variant, scale), pictures(variant, 1))


@pytest.mark.parametrize("scale", [1e-6, 1e-3, 1e3, 1e9])
@variants
def test_other_scales_change_no_more_than_rounding(variant: Variant, scale: float) -> None:
    off = variant.errors(pictures(variant, scale), pictures(variant, 1))
    assert off.max() <= CHANGE + 5 * variant.rounding
