"""Shares add up as sums do, not as ratios."""

from __future__ import annotations

import math

from svgf_cl.compare.share import Share


def test_a_share_of_much_counts_more() -> None:
    assert (Share(1, 2) + Share(0, 6)).value == 1 / 8


def test_nothing_of_nothing_is_no_figure() -> None:
    assert math.isnan(Share().value)
    assert math.isnan(Share(1.0, -1.0).value)
    assert math.isnan((Share(1, 2) + Share(math.nan, 1)).value)
