"""A series follows one thing; all else stays."""

from __future__ import annotations

import pytest

from svgf_cl.bench.scaling import series, table
from tests.svgf_cl.bench.runs import result, run, whole_run


@pytest.mark.parametrize(("over", "where"), [("iterations", (1, 2)), ("cores", (1, 2)), ("pixels", (921600, 1843200))])
def test_a_series(over: str, where: tuple[float, ...]) -> None:
    (found,) = series(whole_run(), over)
    assert found.over == where
    assert found.seconds[1] == pytest.approx(2 * found.seconds[0])


def test_one_point_is_no_series() -> None:
    assert series(run(result("frame", "event", 1.0)), "pixels") == []


def test_linear_is_one_per_pixel() -> None:
    run_ = whole_run()
    assert [row[-1] for row in table("pixels", series(run_, "pixels")).rows] == ["1.00", "1.00"]
    assert [row[-1] for row in table("signals", series(run_, "signals")).rows] == ["1.00", "2.00"]
