"""The rounding error of a picture: relative to large values, absolute for values near zero."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.floating]

# The denominator of an error is the value plus this share of the mean. So the error is relative where the value is
# large, and absolute near zero. For a colour, the value is the greatest of its channels: kernels store luminance
# instead of green, so a green that hardly contributes to luminance has a large relative error.
SCALE_SHARE = 1e-3


def largest_channel(colors: Array) -> Array:
    """The greatest |channel| of each colour: (..., 3) to (..., 1)."""
    largest: Array = np.abs(colors).max(axis=-1, keepdims=True)
    return largest


def counted_against(size: Array) -> Array:
    """The denominator of an error: the size of a value plus `SCALE_SHARE` of the mean size; never 0."""
    counted: Array = size + (SCALE_SHARE * size.mean() or 1.0)
    return counted


def relative_error(got: Array, expected: Array, size: Array | None = None) -> Array:
    """|got - expected| divided by its denominator, of the same shape; by default, the size is |expected|."""
    error: Array = np.abs(got - expected) / counted_against(np.abs(expected) if size is None else size)
    return error
