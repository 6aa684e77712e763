"""A bar holds from its factor on; the spread does not decide."""

from __future__ import annotations

import pytest

from benchmarks.bars import BARS, Bar
from benchmarks.race import Spread


@pytest.mark.parametrize(("median", "verdict"), [(14.99, "missed"), (15.0, "holds"), (20.0, "holds")])
def test_the_median_decides(median: float, verdict: str) -> None:
    assert Bar("bar", "OIDN high", 15).verdict(Spread(median, 10.0, 30.0)) == verdict


def test_the_bars_as_they_were_set() -> None:
    assert [str(bar) for bar in BARS] == ["bar: 15 x OIDN high", "bar: 8 x OIDN fast", "aim: 15 x OIDN fast"]
