"""Tables say what the run holds, and a dash where it holds nothing."""

from __future__ import annotations

import pytest

from svgf_cl.bench.tables import benchmark_table, device_table, memory_table, milliseconds
from tests.svgf_cl.bench.runs import device, result, run, whole_run


@pytest.mark.parametrize(
    ("seconds", "text"), [(1.2345e-7, "0.000123"), (1.2345e-4, "0.123"), (0.0123, "12.30"), (1.5, "1500")]
)
def test_milliseconds(seconds: float, text: str) -> None:
    assert milliseconds(seconds) == text


def test_speed_stands_beside_error() -> None:
    table = device_table(whole_run())
    assert table.columns == ("", "Alpha")
    assert [value for _, value in table.rows[-7:]] == ["100", "10", "900", "300", "400", "1.5e-07", "9.0e-07"]


def test_event_and_host_time_share_a_row() -> None:
    timed = whole_run()
    rows = {row[0]: row[1:] for row in benchmark_table(timed, timed.devices[0]).rows}
    assert rows["svgf.temporal.1280x720"] == ("6.50 ±23%", "7.50 ±20%", "80", "arithmetic", "11", "217", "1085", "2")
    assert rows["svgf.enqueue.1280x720"] == ("-", "7.50 ±20%", "-", "-", "-", "-", "-", "2")


def test_columns_in_which_nothing_was_measured_are_left_out() -> None:
    hosts = run(result("enqueue", "host", 1.0), result("start cold", "host", 2.0))
    table = benchmark_table(hosts, hosts.devices[0])
    assert table.columns == ("benchmark", "host ms", "rounds")
    assert table.rows[0] == ("svgf.enqueue.1280x720", "1.00 ±0%", "1")


def test_without_ceilings_no_rooflines() -> None:
    bare = run(result("temporal", "event", 1.0), devices=(device(ceilings=None),))
    assert device_table(bare).title == "devices, and the error"
    assert [what for what, _ in device_table(bare).rows][4:6] == ["tuning", "error to the float64 oracle, rms"]
    assert benchmark_table(bare, bare.devices[0]).columns == ("benchmark", "event ms", "rounds")


def test_memory_by_size() -> None:
    assert memory_table(whole_run()).rows == [("1280x720", "100"), ("1280x1440", "100")]


def test_every_row_fits_its_columns() -> None:
    timed = whole_run()
    for table in (device_table(timed), benchmark_table(timed, timed.devices[0]), memory_table(timed)):
        assert table.rows
        assert all(len(row) == len(table.columns) for row in table.rows)
