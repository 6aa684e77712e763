"""variance.cl: over space while history is short, over time when it is long."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.lib.stride_tricks import sliding_window_view
from numpy.testing import assert_allclose, assert_array_equal

from tests.denoising import feed
from tests.frames import noise, wall

LUMINANCE = np.array((0.2126, 0.7152, 0.0722))


def test_constant_image_has_none() -> None:
    assert_allclose(feed(wall())[1].stage("variance"), 0, atol=1e-30)


def test_miss_has_none() -> None:
    holes = np.where(noise()[..., 0] < 0.3, np.inf, 4.0)
    variance = feed(wall(color=noise(1), depth=holes))[1].stage("variance")[0]
    assert_array_equal(variance > 0, np.isfinite(holes))


def test_first_frame_takes_four_times_that_of_the_neighbourhood() -> None:
    variance = feed(wall(color=noise()))[1].stage("variance")[0]
    windows = sliding_window_view(noise() @ LUMINANCE, (7, 7))
    assert_allclose(variance[3:-3, 3:-3], 4 * windows.var(axis=(-2, -1)), rtol=1e-4)


def test_steady_bright_light_does_not_cancel() -> None:
    dim = noise() @ LUMINANCE
    bright = feed(wall(color=1000 + noise()))[1].stage("variance")[0]
    windows = sliding_window_view(dim, (7, 7))
    assert_allclose(bright[3:-3, 3:-3], 4 * windows.var(axis=(-2, -1)), rtol=2e-3)


@pytest.mark.parametrize("count", range(1, 7))
def test_from_the_fourth_frame_on_it_is_that_over_time(count: int) -> None:
    _, den = feed(*[wall(color=noise(seed)) for seed in range(count)])
    over_time = (den.stage("variance") == den.stage("moment_variance")).all()
    assert over_time == (count >= 4)
