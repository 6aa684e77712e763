"""What tells surfaces apart, in the oracle of every a-trous wavelet filter (docs/algorithm.md, section 4)."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from svgf_cl import Settings
from svgf_cl.oracle.spatial import surface_weight
from svgf_cl.oracle.taps import depth_gradient, shifted
from tests.frames import FACING
from tests.svgf_cl.oracle.scenes import SHAPE, guides_of, wall


def test_depth_weight_of_a_distant_tap() -> None:
    y, x = np.indices(SHAPE)
    guides = guides_of(wall(depth=8 + 0.5 * x - 0.25 * y))
    weight = surface_weight(guides, depth_gradient(guides.depth), (2, -1), 4, Settings(taps="5x5", sigma_depth=2))
    slope = 2 * 0.5 + 0.25
    assert_allclose(weight[6, 3], np.exp(-4 * slope / (4 * (2 * slope + 1e-3 * 8 * 2))))


@pytest.mark.parametrize("offset", [(1, 0), (-2, 1), (2, 2)])
def test_weight_is_symmetric_on_a_facing_surface(rng: np.random.Generator, offset: tuple[int, int]) -> None:
    guides = guides_of(wall(normal=FACING + rng.normal(0, 0.1, (*SHAPE, 3))))
    gradient = depth_gradient(guides.depth)
    there = surface_weight(guides, gradient, offset, 2, Settings(taps="5x5"))
    back = surface_weight(guides, gradient, (-offset[0], -offset[1]), 2, Settings(taps="5x5"))
    y, x, inside = shifted(offset, SHAPE, 2)
    assert_allclose(there[inside], back[y, x][inside], rtol=1e-12)
    assert 0 < there[inside].min() < there.max() < 1
