"""What the comparison prints and writes."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import pytest

from benchmarks import versus_oidn
from benchmarks.race import DEVICE, WHOLE
from benchmarks.versus_oidn import Table, bar_table, ratio_table, time_table

TIMES = {
    WHOLE: [10.0, 20.0, 10.0],
    DEVICE: [5.0, 10.0, 5.0],
    "OIDN high": [140.0, 280.0, 140.0],
    "OIDN fast": [80.0, 160.0, 80.0],
}


def run(monkeypatch: pytest.MonkeyPatch, *argv: str | Path) -> int:
    """Exit code of the program."""
    monkeypatch.setattr(sys, "argv", ["versus_oidn", *map(str, argv)])
    with pytest.raises(SystemExit) as left:
        versus_oidn.main()
    return int(left.value.code or 0)


def test_times_and_memory() -> None:
    table = time_table("title", TIMES, {WHOLE: 3 << 20, "OIDN fast": 7 << 20})
    assert table.rows[0] == [WHOLE, "10.0", "10.0", "18.0", "3"]
    assert [row[-1] for row in table.rows] == ["3", "", "", "7"]


def test_ratios_are_those_of_rivals() -> None:
    assert ratio_table(TIMES).rows == [
        ["OIDN high", "14.00 (14.00-14.00)", "28.00 (28.00-28.00)"],
        ["OIDN fast", "8.00 (8.00-8.00)", "16.00 (16.00-16.00)"],
    ]


def test_bars_are_judged_on_both_times() -> None:
    assert bar_table(TIMES).rows == [
        ["bar: OIDN high / 15", "14.00 missed", "28.00 holds"],
        ["bar: OIDN fast / 8", "8.00 holds", "16.00 holds"],
        ["aim: OIDN fast / 15", "8.00 missed", "16.00 holds"],
    ]


def test_markdown() -> None:
    assert Table("T", ("a", "b"), [("1", "2")]).markdown() == "T:\n\n| a | b |\n| --- | --- |\n| 1 | 2 |\n"


def test_wrong_input_ends_in_one_line(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(monkeypatch, "--set", "iterations=many") == 2
    said = capsys.readouterr().err
    assert said.startswith("versus_oidn: --set iterations: expected a whole number")
    assert said.count("\n") == 1


def test_it_runs(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    pytest.importorskip("pyoidn", reason="pyoidn is not installed: pip install '.[oidn]'")
    target = tmp_path / "versus.json"
    options = ("--size", "64x36", "--rounds", "2", "--set", "iterations=2", "--markdown", "--json", target)
    assert run(monkeypatch, *options) == 0
    assert "| bar: OIDN high / 15 | " in capsys.readouterr().out
    record = json.loads(target.read_text())
    assert record["settings"]["iterations"] == 2
    assert {len(samples) for samples in record["milliseconds"].values()} == {2}
    assert all(size > 0 for size in record["bytes"].values())
