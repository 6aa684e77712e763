"""Noise far smaller than the light it lies on: its deviation is known to a rounding of the light, nothing cancels."""

from __future__ import annotations

import numpy as np
import pytest

from svgf_cl.oracle.svgf import Oracle
from tests.hard.variants import Variant, on

# Moments are kept of each signal, in 32 bits or 16; the levels (fast) and TAA come after them.
variants = on("precise", "precise, two signals, TAA", "fp16")

STEADY = 1e4
SHAPE = (12, 40)


@pytest.mark.parametrize("noise", [1e-1, 1e-2, 1e-3, 1e-4])
@variants
def test_deviation_of_steady_light_is_off_by_a_rounding_of_it(variant: Variant, noise: float) -> None:
    """The paper's raw moments are off by more than the deviation at a noise of 1e-4: docs/accuracy.md."""
    den, oracle = variant.denoiser(SHAPE), Oracle(SHAPE, variant.settings)
    rng = np.random.default_rng(0)
    for _ in range(12):
        frame = variant.wall(STEADY * (1 + noise * rng.standard_normal((*SHAPE, 1))), shape=SHAPE)
        den.denoise(frame)
        oracle.denoise(frame)
    found, expected = np.sqrt(den.stage("moment_variance")), np.sqrt(oracle.stages["moment_variance"])
    assert np.abs(found - expected).max() <= variant.rounding * STEADY
