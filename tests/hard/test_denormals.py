"""Denormal numbers, which a device may flush or not: as good as zero in any field."""

from __future__ import annotations

from functools import partial

import pytest
from numpy.testing import assert_allclose

from tests.frames import bumpy_sequence
from tests.hard.fields import Spoil, every_field, every_pixel, some_pixels, with_field
from tests.hard.variants import Variant

DENORMAL = 1e-39


@every_field
@pytest.mark.parametrize("spoil", [some_pixels, every_pixel])
@pytest.mark.parametrize("value", [DENORMAL, -DENORMAL])
def test_counts_as_zero(variant: Variant, name: str, spoil: Spoil, value: float) -> None:
    first, second, *later = bumpy_sequence(variant.fields)
    denormal, zero = (with_field(second, name, partial(spoil, number)) for number in (value, 0))
    for got, expected in zip(
        variant.pictures([first, denormal, *later]), variant.pictures([first, zero, *later]), strict=True
    ):
        # rusticl keeps denormals, so the dimmest light is rounded otherwise.
        assert_allclose(got, expected, rtol=1e-6, atol=2 * DENORMAL)
