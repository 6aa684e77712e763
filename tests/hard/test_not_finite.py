"""NaN, infinity and numbers as good as infinite in any field: a black pixel, a miss or a lost track, to the bit."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from svgf_cl import Frame
from svgf_cl.frame import CHANNELS
from tests.frames import bumpy_sequence
from tests.hard.fields import Spoil, every_pixel, some_pixels, with_field
from tests.hard.variants import Variant, on_each_field

# All garbage is taken out as it comes in, for each signal and for TAA's motion; 16-bit storage converts what is left.
every_field = on_each_field("precise", "precise, two signals, TAA", "fp16, two signals, TAA", "Kalman")
# To Kalman a black frame is a change of light, which it follows.
of_a_running_mean = on_each_field("precise", "precise, two signals, TAA", "fp16, two signals, TAA")

GARBAGE = (np.nan, np.inf, -np.inf, 1e30, -1e30, np.finfo(np.float32).max)

# What a pixel counts as, in all channels, where one of them is NaN or beyond the limit.
LIMITS = dict.fromkeys(CHANNELS, 1e10) | {"depth": 1e20, "motion": 1e6}
COUNTS_AS = dict.fromkeys(CHANNELS, 0.0) | {"depth": np.inf, "motion": 1e6}

LIGHT, EMISSION = 0.25, 0.125


def substituted(name: str, field: np.ndarray) -> np.ndarray:
    """The field as it counts."""
    if name == "albedo":
        return np.nan_to_num(np.clip(field, 0, 1), nan=1)
    bad = ~(np.abs(field) <= LIMITS[name])
    if field.ndim == 3:
        bad = bad.any(axis=-1, keepdims=True)
    return np.where(bad, np.float32(COUNTS_AS[name]), field)


def spoiled_sequence(variant: Variant, name: str, spoil: Spoil, values: Sequence[float] = GARBAGE) -> list[Frame]:
    """Good frames that all move elsewhere, after each but the last one that is spoiled."""
    frames = bumpy_sequence(variant.fields, count=2 * len(values) + 1)
    for number, value in enumerate(values):
        frames[1 + 2 * number] = with_field(frames[1 + 2 * number], name, partial(spoil, value))
    return frames


@every_field
@pytest.mark.parametrize("spoil", [some_pixels, every_pixel])
def test_is_what_it_counts_as_to_the_bit(variant: Variant, name: str, spoil: Spoil) -> None:
    frames = spoiled_sequence(variant, name, spoil)
    clean = [with_field(frame, name, partial(substituted, name)) for frame in frames]
    for got, expected in zip(variant.pictures(frames), variant.pictures(clean), strict=True):
        assert np.isfinite(got).all()
        assert_array_equal(got, expected)


@every_field
def test_follows_the_oracle(variant: Variant, name: str) -> None:
    variant.assert_follows_oracle(spoiled_sequence(variant, name, some_pixels, GARBAGE[::3]))


@of_a_running_mean
def test_frame_is_forgotten_as_fast_as_a_black_one(variant: Variant, name: str) -> None:
    """Of its light a share of alpha_color is missed, then less by 1 - alpha_color in every frame."""
    frame = variant.wall(LIGHT, emission=EMISSION)
    bad = with_field(frame, name, partial(every_pixel, np.nan))
    alpha = variant.settings.alpha_color
    pictures = list(variant.pictures([*[frame] * 8, bad, *[frame] * 24]))
    for age, picture in enumerate(pictures[8:]):
        missed = alpha * (1 - alpha) ** age + 4 * variant.rounding
        glow = EMISSION if age == 0 else 0
        assert_allclose(picture, LIGHT + EMISSION, rtol=0, atol=LIGHT * missed + glow)
