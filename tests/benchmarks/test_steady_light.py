"""What keeping mean and variance is worth: raw moments cancel, these do not."""

from __future__ import annotations

import numpy as np
from numpy.testing import assert_allclose

from benchmarks.steady_light import SHAPE, errors, raw_moments, steady_frames


def test_kernels_are_a_thousand_times_nearer_than_raw_moments() -> None:
    raw, single, half = errors(1e-3)
    assert raw > 1000 * single
    assert 0.05 < raw < 1
    assert half < 1


def test_raw_moments_are_right_where_noise_is_strong() -> None:
    frames = list(steady_frames(0.5, count=200))
    spread = np.var([frame.color[..., 0] for frame in frames], axis=0)
    assert_allclose(raw_moments(frames, alpha=0), spread, rtol=1e-3)
    assert spread.shape == SHAPE
