"""Measurements are of what they say: every variant, its own frames, its own truth."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from benchmarks import measurements
from benchmarks.footage import Footage
from benchmarks.variants import Variant
from svgf_cl import Eaw

QUICK = Eaw(iterations=1)  # to compile, as the filter does not matter
VARIANTS = (
    Variant("plain", QUICK),
    Variant("antialiased", replace(QUICK, taa=True)),
    Variant("split", QUICK, signals=2),
)
CENTRE = Footage("centre", jitter=False, shape=(45, 80), band=(0.6, 0.9), frames=4, spp=32)
AREA = Footage("area", jitter=True, shape=(45, 80), band=(0.6, 0.9), frames=4, spp=32)


def test_everything_is_measured_and_progress_adds_up(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("flip_evaluator")
    monkeypatch.setattr(measurements, "error_to_oracle", lambda settings, signals: (5.0 + settings.taa, signals))
    ticks: list[None] = []
    expected = measurements.steps(VARIANTS, (AREA, CENTRE), 2)
    results, noise = measurements.measure(VARIANTS, (AREA, CENTRE), (45, 80), 2, lambda: ticks.append(None))
    assert len(ticks) == expected
    assert [result.variant for result in results] == list(VARIANTS)
    assert [list(result.quality) for result in results] == [["area", "centre"], ["area"], ["area", "centre"]]
    for result in results:
        assert min(result.times.device, result.times.frame) > 0
    assert [(result.oracle_largest, result.oracle_rms) for result in results] == [(5, 1), (6, 1), (5, 2)]
    assert list(noise) == ["area", "centre"]
    # Even so little truth is cleaner than what is made of 1 sample per pixel.
    assert noise["centre"].relmse < 1


def test_a_busy_machine_changes_no_ratio() -> None:
    # The second takes twice the first's time; the machine is slow for half the turns, and cuts one of them short.
    first = [10, 10, 10, 30, 30, 10, 10]
    second = [20, 20, 20, 60, 60, 60, 20]
    assert measurements.paired_medians([first, second]) == [10, 20]


def test_a_variant_is_judged_by_the_rows_and_frames_that_have_a_truth() -> None:
    split, single = Variant("split", QUICK, signals=2), Variant("single", QUICK)
    pictures = measurements.judged_pictures([split, single], CENTRE, lambda: None)
    assert list(pictures) == [split, single]
    assert np.shape(pictures[split]) == (2, 13, 80, 3)
    assert not np.array_equal(pictures[split], pictures[single])


def test_quality_is_the_mean_over_frames_and_the_change_between_them() -> None:
    pytest.importorskip("flip_evaluator")
    dark, bright = np.zeros((16, 16, 3)), np.ones((16, 16, 3))
    found = measurements.quality([dark, dark], [bright, 0.5 * bright])
    assert found.relmse == pytest.approx((1 / 1.01 + 0.25 / 0.26) / 2)
    # 0.5 is shown as 0.7353570: the error goes from 1 to that.
    assert found.psnr == pytest.approx(-20 * np.log10(0.7353570) / 2)
    assert found.temporal == pytest.approx(1 - 0.7353570)
