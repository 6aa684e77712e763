"""The measure of accuracy sees what it should: a wrong kernel by name, and nothing where all is right."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from svgf_cl import Denoiser, Settings, reference
from svgf_cl.accuracy import DECISION, SCALE_SHARE, deviations, relative_error, summary
from tests.frames import SPLIT, TINY, bumpy_sequence


@pytest.mark.parametrize("taa", [False, True])
def test_covers_every_stage_and_the_result(taa: bool) -> None:
    frames = bumpy_sequence(SPLIT, count=2, shape=TINY)
    den = Denoiser(TINY, settings=Settings(taa=taa))
    den.denoise(frames[0])
    assert set(deviations(frames, Settings(taa=taa))) == {*den.stages, "out"}


@pytest.mark.parametrize("kernel", ["temporal", "atrous"])
def test_a_wrong_kernel_shows_in_its_own_stages_alone(kernel: str, monkeypatch: pytest.MonkeyPatch) -> None:
    right = getattr(reference, kernel)
    stages = {"temporal": {"accumulated", "mean", "moment_variance"}, "atrous": {"level_1", "level_1_variance"}}

    def wrong(color, *rest):
        return right(1.01 * color, *rest)

    monkeypatch.setattr(reference, kernel, wrong)
    found = deviations(bumpy_sequence(SPLIT, shape=TINY), Settings(iterations=1))
    assert {name for name, deviation in found.items() if deviation.decided_otherwise > 0.1} <= stages[kernel]
    assert any(deviation.decided_otherwise > 0.5 for deviation in found.values())


def test_error_is_relative_to_the_value_or_to_the_mean() -> None:
    expected = np.array([0.0, 1.0, 2.0, -1.0])
    scale = SCALE_SHARE * 1.0
    assert_allclose(relative_error(expected + 1e-6, expected), 1e-6 / (np.abs(expected) + scale))


def test_all_zero_is_right_or_wholly_wrong() -> None:
    assert relative_error(np.zeros(3), np.zeros(3)).max() == 0
    assert relative_error(np.ones(3), np.zeros(3)).min() >= DECISION


def test_summary_sets_aside_what_was_decided_otherwise() -> None:
    found = summary("out", np.array([0.0, 1e-6, 3e-6, 1.0, np.nan]))
    assert (found.stage, found.largest, found.decided_otherwise, found.pixels) == ("out", 3e-6, 0.4, 5)
