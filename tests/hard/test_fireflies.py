"""One sample far too bright: held against the oracle, kept on its own surface, and gone as fast as its share decays."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from svgf_cl import Frame
from tests.frames import FACING, SHAPE, TINY
from tests.hard.variants import Variant, on

# Storage ends at 65504, TAA compresses, and weights have to tell light that bright: each way to do so, once.
variants = on("precise", "precise, two signals, TAA", "fp16", "fast", "Kalman")
# A share of the new frame decays alike whatever the levels' weights: these spread it.
of_decay = on("precise", "precise, two signals, TAA", "fp16")

# All that is not taken for garbage (test_not_finite.py).
every_firefly = pytest.mark.parametrize("firefly", [1e4, 1e7, 1e10])


@every_firefly
@variants
def test_follows_the_oracle(variant: Variant, firefly: float) -> None:
    rng = np.random.default_rng(0)
    frames = [variant.wall(rng.exponential(0.5, (*SHAPE, 3)) + firefly * spot(age == 2)) for age in range(8)]
    variant.assert_follows_oracle(frames, error=variant.outshone)


def spot(lit: bool, at: tuple[int, int] = (20, 18)) -> np.ndarray:
    """One lit pixel, or none."""
    image = np.zeros((*SHAPE, 1))
    image[at] = lit
    return image


@every_firefly
@of_decay
def test_decays_by_its_share_in_every_frame(variant: Variant, firefly: float) -> None:
    """No pixel holds more of it than alpha_color (1 - alpha_color)^age, however the filter spreads it."""
    light = 0.5
    dark = variant.wall(light, shape=TINY)
    bright = variant.wall(light + firefly * spot(True, at=(3, 4))[: TINY[0], : TINY[1]], shape=TINY)
    alpha = variant.settings.alpha_color
    pictures = list(variant.pictures([*[dark] * 8, bright, *[dark] * 140], TINY))[8:]
    for age, picture in enumerate(pictures):
        left = alpha * (1 - alpha) ** age * min(firefly, variant.signals * variant.greatest)
        assert_allclose(picture, light, rtol=4 * variant.rounding, atol=left)
    assert left < 1e-2 * light


@every_firefly
@variants
def test_lights_no_other_surface(variant: Variant, firefly: float) -> None:
    left = np.arange(SHAPE[1])[:, None] < 19
    normal = np.where(left, FACING, (1.0, 0.0, 0.0))

    def frame(lit: bool) -> Frame:
        return variant.wall(0.5 + firefly * spot(lit), normal=normal)

    for picture in variant.pictures([frame(False), frame(True), frame(False), frame(False)]):
        assert_allclose(picture[:, ~left[:, 0]], 0.5, rtol=4 * variant.rounding)
