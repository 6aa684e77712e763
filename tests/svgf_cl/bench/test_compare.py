"""A comparison tells ratios, and all that makes them doubtful."""

from __future__ import annotations

from svgf_cl.bench.compare import comparison, differences
from tests.svgf_cl.bench.runs import device, result, run

OLD = run(result("temporal", "event", 8.0), result("frame", "event", 20.0), result("gone", "event", 1.0))
NEW = run(result("temporal", "event", 2.0), result("frame", "event", 20.0), result("fresh", "event", 1.0))


def test_ratios_of_what_both_ran() -> None:
    table = comparison(OLD, NEW)
    assert [row[0] for row in table.rows] == ["svgf.temporal.1280x720", "svgf.frame.1280x720", "geometric mean"]
    assert [row[-1] for row in table.rows] == ["4.00", "1.00", "2.00"]


def test_names_on_one_side() -> None:
    assert differences(OLD, NEW) == [
        "only in the old run: svgf.gone.1280x720",
        "only in the new run: svgf.fresh.1280x720",
    ]


def test_another_driver_and_device() -> None:
    new = run(*OLD.results, devices=(device(driver="2.0"), device("1:0", platform="Beta")))
    assert differences(OLD, new) == ["Alpha: driver was 1.0, is 2.0", "only the new run has Beta"]
    assert differences(new, OLD) == ["Alpha: driver was 2.0, is 1.0", "only the old run has Beta"]


def test_devices_are_matched_by_implementation_not_by_number() -> None:
    """Another driver installed shifts the numbers."""
    new = run(result("temporal", "event", 4.0, on="1:0"), devices=(device("1:0"),))
    assert [row[-1] for row in comparison(OLD, new).rows] == ["2.00", "2.00"]


def test_nothing_in_common() -> None:
    assert comparison(run(), NEW).rows == []
