"""Metrics against values worked out by hand."""

from __future__ import annotations

import math
import sys
from dataclasses import astuple

import numpy as np
import pytest

from svgf_cl import SvgfError
from svgf_cl.compare import metrics
from svgf_cl.compare.metrics import Metrics

RNG = np.random.default_rng(3)


def grey(value: float, size: int = 16) -> np.ndarray:
    return np.full((size, size, 3), value, np.float32)


def test_equal_pictures_are_perfect() -> None:
    picture = RNG.random((16, 18, 3), np.float32)
    assert metrics.measure(picture, picture) == Metrics(math.inf, 1.0, 0.0)


def test_psnr_and_relmse_of_known_greys() -> None:
    # Black against white: the shown error is 1 everywhere.
    assert metrics.measure(grey(0.0), grey(1.0)).psnr == pytest.approx(0.0)
    assert metrics.measure(grey(0.0), grey(1.0)).relmse == pytest.approx(1 / 1.01)
    # 0.5 linear is 0.7353570 in sRGB.
    assert metrics.measure(grey(0.5), grey(1.0)).psnr == pytest.approx(-20 * math.log10(1 - 0.7353570), abs=1e-4)


def test_what_is_brighter_than_white_counts_in_relmse_only() -> None:
    found = metrics.measure(grey(5.0), grey(2.0))
    assert found.psnr == math.inf
    assert found.relmse == pytest.approx(9 / 4.01)


def test_the_worst_hundredth_of_pixels_can_be_left_out() -> None:
    dotted = grey(0.6, 20)
    dotted[3, 4:8] = 1e3  # 4 of 400 pixels
    assert metrics.trimmed_relmse(dotted, grey(0.5, 20)) == pytest.approx(0.01 / 0.26, rel=1e-5)
    dotted[3, 8] = 5.5
    assert metrics.trimmed_relmse(dotted, grey(0.5, 20)) == pytest.approx((395 * 0.01 + 25) / 396 / 0.26, rel=1e-5)
    assert metrics.trimmed_relmse(dotted, dotted) == 0


def test_nan_is_not_left_out_with_the_worst() -> None:
    broken = grey(0.5)
    broken[0, 0, 0] = np.nan
    assert math.isnan(metrics.trimmed_relmse(broken, grey(0.5)))


def test_exposure_brings_light_back_into_range() -> None:
    assert metrics.measure(grey(5.0), grey(2.0), exposure=-3).psnr == metrics.measure(grey(5 / 8), grey(2 / 8)).psnr


def test_nan_is_never_a_good_score() -> None:
    broken = grey(0.5)
    broken[0, 0, 0] = np.nan
    found = metrics.measure(broken, grey(0.5))
    assert all(map(math.isnan, astuple(found)))


def test_flip_tells_equal_from_opposite() -> None:
    pytest.importorskip("flip_evaluator")
    assert metrics.flip(grey(0.5), grey(0.5)) == 0
    assert metrics.flip(grey(0.0), grey(1.0)) == pytest.approx(1, abs=0.05)
    assert 0 < metrics.flip(grey(0.50), grey(0.52)) < metrics.flip(grey(0.5), grey(0.6))


def test_flip_of_nan_is_nan() -> None:
    pytest.importorskip("flip_evaluator")
    broken = grey(0.5)
    broken[0, 0, 0] = np.nan
    assert math.isnan(metrics.flip(broken, grey(0.5)))
    assert math.isnan(metrics.flip(grey(0.5), broken))


def test_without_its_library_flip_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "flip_evaluator", None)
    with pytest.raises(SvgfError, match=r"pip install 'svgf-cl\[metrics\]'"):
        metrics.flip(grey(0.5), grey(0.5))


def test_an_error_that_stands_still_is_no_temporal_error() -> None:
    first, second = RNG.random((2, 16, 18, 3))
    assert metrics.temporal_error((first + 0.1, second + 0.1), (first, second)) == pytest.approx(0)


def test_temporal_error_is_what_the_error_changes_by() -> None:
    # Too bright by 0.1, then too dark by 0.2, in a quarter of the values.
    truth = np.full((16, 16, 3), 0.5)
    earlier, later = truth.copy(), truth.copy()
    earlier[:4] += 0.1
    later[:4] -= 0.2
    assert metrics.temporal_error((earlier, later), (truth, truth)) == pytest.approx(0.3 / 4)
    # The truth moves and the picture lags.
    assert metrics.temporal_error((truth, truth), (truth, truth + 0.3)) == pytest.approx(0.3)


def test_noise_lowers_every_metric() -> None:
    truth = RNG.random((32, 32, 3), np.float32)
    little, much = (metrics.measure(truth + s * RNG.normal(size=truth.shape), truth) for s in (0.01, 0.1))
    assert little.psnr > much.psnr
    assert little.ssim > much.ssim
    assert little.relmse < much.relmse


def test_sizes_are_checked() -> None:
    with pytest.raises(SvgfError, match="one shape"):
        metrics.measure(grey(0.5, 16), grey(0.5, 17))
    with pytest.raises(SvgfError, match="at least 11x11 pixels, got 8x8"):
        metrics.measure(grey(0.5, 8), grey(0.5, 8))
