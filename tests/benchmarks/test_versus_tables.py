"""Tables say what was measured."""

from __future__ import annotations

from benchmarks.measurements import Quality
from benchmarks.race import DEVICE, WHOLE
from benchmarks.versus_tables import Table, bar_table, error_table, ratio_table, time_table

TIMES = {
    WHOLE: [10.0, 20.0, 10.0],
    DEVICE: [5.0, 10.0, 5.0],
    "OIDN high": [140.0, 280.0, 140.0],
    "OIDN fast": [80.0, 160.0, 80.0],
}


def test_times_and_memory() -> None:
    table = time_table(TIMES, {WHOLE: 3 << 20, "OIDN fast": 7 << 20})
    assert table.rows[0] == [WHOLE, "10.0", "10.0", "18.0", "3"]
    assert [row[-1] for row in table.rows] == ["3", "", "", "7"]


def test_ratios_are_those_of_rivals() -> None:
    assert ratio_table(TIMES).rows == [
        ["OIDN high", "14.00 (14.00-14.00)", "28.00 (28.00-28.00)"],
        ["OIDN fast", "8.00 (8.00-8.00)", "16.00 (16.00-16.00)"],
    ]


def test_bars_are_judged_on_both_times() -> None:
    assert bar_table(TIMES).rows == [
        ["bar: 15 x OIDN high", "14.00 missed", "28.00 holds"],
        ["bar: 8 x OIDN fast", "8.00 holds", "16.00 holds"],
        ["aim: 15 x OIDN fast", "8.00 missed", "16.00 holds"],
    ]


def test_markdown() -> None:
    assert Table("T", ("a", "b"), [("1", "2")]).markdown() == "T:\n\n| a | b |\n| --- | --- |\n| 1 | 2 |\n"


def test_errors() -> None:
    found = Quality(psnr=30.125, relmse=0.01, flip=0.05, temporal=0.0072)
    assert error_table({"svgf_cl": found}).rows == [["svgf_cl", "30.12", "0.0100", "0.0500", "0.0072"]]
