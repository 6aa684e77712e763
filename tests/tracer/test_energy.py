from __future__ import annotations

import math

import numpy as np
import pytest

from svgf_cl_tracer.energy import ALPHA_FLOOR, mean_terms, terms

# Midpoints: the mean over the projected hemisphere is that of cosine^2.
SQUARES = (np.arange(20_000) + 0.5) / 20_000


def test_the_widest_lobe_loses_what_its_closed_form_does() -> None:
    """For alpha = 1, seen from above, the albedo is the integral of x / (1 + x) over 0..1."""
    assert terms(1.0, 1.0).lost == pytest.approx(math.log(2.0), abs=2e-3)


@pytest.mark.parametrize("cosine", [0.02, 0.1, 0.5, 0.9, 1.0])
def test_the_narrowest_lobe_is_a_mirror(cosine: float) -> None:
    lost, bias = terms(cosine, ALPHA_FLOOR)
    assert lost == pytest.approx(0.0, abs=1e-4)
    assert bias == pytest.approx((1.0 - cosine) ** 5, abs=3e-3)


@pytest.mark.parametrize("alpha", [ALPHA_FLOOR, 0.003, 0.1, 0.77, 1.0])
def test_the_mean_is_that_of_the_table(alpha: float) -> None:
    found = np.mean([terms(math.sqrt(square), alpha) for square in SQUARES], axis=0)
    np.testing.assert_allclose(found, mean_terms(alpha), rtol=2e-3, atol=1e-6)


def test_schlicks_mean_over_the_hemisphere_is_1_in_21() -> None:
    assert mean_terms(ALPHA_FLOOR).bias == pytest.approx(1.0 / 21.0, rel=5e-3)


def test_rougher_surfaces_lose_more() -> None:
    lost = [mean_terms(alpha).lost for alpha in np.linspace(ALPHA_FLOOR, 1.0, 200)]
    assert np.diff(lost).min() > 0.0
    assert 0.0 < lost[0] < 1e-5
    assert 0.5 < lost[-1] < 0.6


def test_rounding_does_not_leave_the_table() -> None:
    assert terms(-1e-9, 0.5) == terms(0.0, 0.5)
    assert terms(1.0 + 1e-9, 2.0) == terms(1.0, 1.0)
