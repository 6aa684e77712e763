"""How far rounding took a picture: an error relative to what there is, where there is something to be relative to."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.floating]

# An error counts against the value plus this share of the mean: a relative error where there is something to be
# relative to, an absolute one near zero. Of a colour, the value is the greatest of its channels: kernels keep luminance
# in place of green, and a green that hardly contributes to it cannot be known as well.
SCALE_SHARE = 1e-3


def largest_channel(colors: Array) -> Array:
    """The greatest |channel| of each colour: (..., 3) to (..., 1)."""
    largest: Array = np.abs(colors).max(axis=-1, keepdims=True)
    return largest


def counted_against(size: Array) -> Array:
    """What an error is relative to: the size of a value, and `SCALE_SHARE` of the mean size; never 0."""
    counted: Array = size + (SCALE_SHARE * size.mean() or 1.0)
    return counted


def relative_error(got: Array, expected: Array, size: Array | None = None) -> Array:
    """|got - expected| over what it counts against, of the same shape; the size is |expected| if not given."""
    error: Array = np.abs(got - expected) / counted_against(np.abs(expected) if size is None else size)
    return error
