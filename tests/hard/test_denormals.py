"""Denormal numbers, which a device may flush or not: as good as zero in any field."""

from __future__ import annotations

import itertools
from functools import partial

from numpy.testing import assert_allclose

from tests.frames import bumpy_sequence
from tests.hard.fields import every_pixel, some_pixels, with_field
from tests.hard.variants import Variant, on_each_field

# Flushed or not as it comes in, in each field that there is; what comes after sees a number like any other.
every_field = on_each_field("precise", "precise, two signals, TAA")

DENORMAL = 1e-39


@every_field
def test_counts_as_zero(variant: Variant, name: str) -> None:
    """Of either sign, in some pixels or in all, each in a frame after a good one."""
    frames = bumpy_sequence(variant.fields, count=9)
    denormal, zero = frames.copy(), frames.copy()
    cases = itertools.product((some_pixels, every_pixel), (DENORMAL, -DENORMAL))
    for number, (spoil, value) in zip(range(1, 9, 2), cases, strict=True):
        denormal[number] = with_field(frames[number], name, partial(spoil, value))
        zero[number] = with_field(frames[number], name, partial(spoil, 0))
    for got, expected in zip(variant.pictures(denormal), variant.pictures(zero), strict=True):
        # rusticl keeps denormals, so the dimmest light is rounded otherwise.
        assert_allclose(got, expected, rtol=1e-6, atol=2 * DENORMAL)
