"""How far around a tile passes must be right, against sums made by hand."""

from __future__ import annotations

import pytest

from svgf_cl.filters import Accumulation, Eaw, Kalman, Sbf, Settings
from svgf_cl.filters.filter import Filter
from svgf_cl.filters.margins import margins, widest_margin
from svgf_cl.filters.signals import Inputs

# From the last pass back: antialiasing 1; levels of taps 1, 2, ... apart; variance 3; depth gradient 1. Kalman has
# guidance 3, update 3, tests of 8, 4 and 2 pixels, and the 2x2 pixels of the first mean.
CASES = [
    (Accumulation(), 1),
    (Accumulation(taa=True), 1 + 1),
    (Eaw(taps="3x3", iterations=3), 1 + 2 + 4 + 1),
    (Settings(taps="3x3", iterations=3), 1 + 2 + 4 + 3 + 1),
    (Settings(taps="5x5", iterations=5, taa=True), 1 + 2 * 31 + 3 + 1),
    (Sbf(), 3 + 16 + 3 + 1),
    (Kalman(taps="3x3", iterations=2), 1 + 2 + 3 + 3 + 8 + 4 + 2 + 1 + 1),
]


@pytest.mark.parametrize(("settings", "margin"), CASES)
def test_the_margin_is_the_sum_along_the_longest_way(settings: Filter, margin: int) -> None:
    assert widest_margin(settings.pipeline(Inputs())) == margin


@pytest.mark.parametrize("settings", [settings for settings, _ in CASES])
def test_margins_shrink_towards_the_result(settings: Filter) -> None:
    pipeline = settings.pipeline(Inputs())
    found = margins(pipeline)
    assert len(found) == len(pipeline.passes)
    assert found[-1] == 0
    assert found[0] == max(found)
