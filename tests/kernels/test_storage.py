"""What saves time or memory: how far it takes the picture from the oracle, and what it cannot hold."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from svgf_cl import Denoiser, Kalman, Settings
from svgf_cl.filters.filter import Filter
from tests.denoising import feed, vector_width
from tests.frames import FULL, SPLIT, bumpy_sequence, wall
from tests.oracle import error_to_oracle

BUMPY = partial(bumpy_sequence, SPLIT)
GUIDES = {"half_guides": True}
HISTORY = {"half_history": True}
FAST = {"precision": "fast"}

# Root-mean-square error over all pixels, relative to the picture's mean; about three times what was measured. 16-bit
# floats round by 2^-12 = 2.4e-4 of a value, normals by 2^-16; fast weights are up to 6 % larger, nearly all alike.
BOUNDS = [
    ({}, 2e-5),
    (GUIDES, 2e-3),
    (HISTORY, 2e-3),
    (GUIDES | HISTORY, 3e-3),
    (FAST, 4e-2),
    (FAST | GUIDES | HISTORY, 4e-2),
]


@pytest.mark.parametrize(("choice", "bound"), BOUNDS, ids=[" ".join(choice) or "precise" for choice, _ in BOUNDS])
def test_error_to_the_oracle(choice: dict[str, Any], bound: float) -> None:
    assert error_to_oracle(BUMPY, Settings(), **choice) <= bound


@pytest.mark.parametrize("choice", [HISTORY, GUIDES | HISTORY])
def test_light_beyond_16_bits_is_held_at_their_greatest(choice: dict[str, Any]) -> None:
    den = Denoiser((9, 33), settings=Settings(**choice))
    for color in (1e6, 1e4, 1e-3):
        out = den.denoise(wall((9, 33), color=color))
        assert np.isfinite(out).all()
        assert out.max() <= 65504


def test_dim_light_keeps_three_digits() -> None:
    out, _ = feed(wall(color=1e-3), **GUIDES, **HISTORY)
    assert_allclose(out, 1e-3, rtol=1e-3)


@pytest.mark.parametrize("kind", [Settings, Kalman])
def test_taps_of_16_bits_need_no_alignment(kind: type[Filter]) -> None:
    """PoCL 3.1 crashed: it reads vectors of halves as if they were aligned, which a neighbour's is not."""
    pictures = []
    for width in (8, 1):
        with vector_width(width):
            pictures.append(feed(*bumpy_sequence(FULL, count=3), kind=kind, taa=True, **HISTORY)[0])
    assert np.isfinite(pictures[0]).all()
    assert np.quantile(np.abs(pictures[0] - pictures[1]), 0.99) < 1e-2 * pictures[1].mean()
