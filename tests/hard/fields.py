"""Any value in any field of a frame."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from svgf_cl import Frame

Change = Callable[[np.ndarray], np.ndarray]
Spoil = Callable[[float, np.ndarray], np.ndarray]


def every_pixel(value: float, field: np.ndarray) -> np.ndarray:
    """A field of one value."""
    return np.full_like(field, value)


def some_pixels(value: float, field: np.ndarray) -> np.ndarray:
    """The field with this value in each of its channels, in pixels apart."""
    spoiled = field.copy()
    for channel, place in enumerate(np.ndindex(field.shape[2:])):
        spoiled[(5 + 7 * channel, 3 + 9 * channel, *place)] = value
    return spoiled


def with_field(frame: Frame, name: str, change: Change) -> Frame:
    return replace(frame, **{name: change(getattr(frame, name))})
