"""Every variant follows the oracle on frames in which nothing fits anything else; and what finds errors finds them."""

from __future__ import annotations

import numpy as np
from numpy.testing import assert_allclose

from tests.frames import bumpy_sequence, noise
from tests.hard.variants import VARIANTS, Variant, on

# All: here the bounds of each are what is tested.
variants = on(*VARIANTS)


@variants
def test_follows_the_oracle(variant: Variant) -> None:
    variant.assert_follows_oracle(bumpy_sequence(variant.fields, count=6))


@variants
def test_even_light_stays_as_it_is(variant: Variant) -> None:
    *_, last = variant.pictures([variant.wall(0.3)] * 3)
    assert_allclose(last, 0.3, rtol=2 * variant.rounding)


@variants
def test_signals_add_up_to_the_light(variant: Variant) -> None:
    frame = variant.wall(noise())
    light = frame.color if variant.signals == 1 else frame.direct + frame.indirect
    assert_allclose(light, noise(), rtol=1e-6)


@variants
def test_a_pixel_off_the_oracle_is_found(variant: Variant) -> None:
    picture = 0.1 + noise()
    off = picture.copy()
    off[3, 4, 1] *= 1 + 4 * variant.error
    assert np.argmax(variant.errors(off, picture)) == np.ravel_multi_index((3, 4), picture.shape[:2])
    assert variant.errors(off, picture).max() > variant.error
