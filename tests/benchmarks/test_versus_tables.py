"""Tables say what was measured."""

from __future__ import annotations

from benchmarks.measurements import Quality
from benchmarks.versus_tables import error_table, ratio_table, time_table
from svgf_cl.bench.rig import EVENT, HOST

TIMES = {
    ("svgf_cl 5x5", HOST): [0.01, 0.02, 0.01],
    ("svgf_cl 5x5", EVENT): [0.005, 0.01, 0.005],
    ("OIDN high", HOST): [0.14, 0.28, 0.14],
    ("OIDN fast", HOST): [0.08, 0.16, 0.08],
}


def test_times_and_memory() -> None:
    table = time_table(TIMES, {"svgf_cl 5x5": 3_000_000, "OIDN high": 9_000_000, "OIDN fast": 7_000_000})
    assert table.rows[0] == ["svgf_cl 5x5", HOST, "10.0", "10.0", "18.0", "3"]
    assert [row[-1] for row in table.rows] == ["3", "", "9", "7"]


def test_ratios_are_those_of_rivals() -> None:
    table = ratio_table(TIMES)
    assert table.columns == ("time of", "over svgf_cl 5x5, host", "over svgf_cl 5x5, event")
    assert table.rows == [
        ["OIDN high", "14.00 (14.00-14.00)", "28.00 (28.00-28.00)"],
        ["OIDN fast", "8.00 (8.00-8.00)", "16.00 (16.00-16.00)"],
    ]


def test_errors() -> None:
    found = Quality(psnr=30.125, relmse=0.01, flip=0.05, temporal=0.0072)
    assert error_table({"svgf_cl": found}).rows == [["svgf_cl", "30.12", "0.0100", "0.0500", "0.0072"]]
