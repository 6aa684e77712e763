"""``svgf-cl bench`` as people use it."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from svgf_cl.device import devices
from tests.command_line import run


@pytest.fixture
def quick_ceilings(monkeypatch: pytest.MonkeyPatch) -> None:
    """Ceilings of no worth, measured at once, and an error that was not measured."""
    monkeypatch.setattr("svgf_cl.bench.ceilings.WORKING_SETS", (2**22,))
    monkeypatch.setattr("svgf_cl.bench.ceilings.COPIED", 1)
    monkeypatch.setattr("svgf_cl.bench.station.error_to_oracle", lambda *_, **__: (2e-7, 1e-7))
    monkeypatch.setattr("svgf_cl.bench.suite.timed_devices", lambda: [devices.choose(devices.list_devices())])


@pytest.mark.usefixtures("quick_ceilings")
def test_bench_writes_a_report_and_compares(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    argv = ("bench", "--only", "frame.16x9", "--size", "16x9", "--seconds", "0", "-o", tmp_path)
    assert run(*argv) == 0
    assert sorted(path.name for path in tmp_path.iterdir()) == ["report.html", "results.json", "summary.png"]
    shown = capsys.readouterr().out
    assert "kalman.frame.16x9" in shown
    assert "2.0e-07" in shown, "speed stands beside error"
    assert run(*argv, "--compare", tmp_path / "results.json") == 0
    assert "times faster" in capsys.readouterr().out
    assert "times faster" in (tmp_path / "report.html").read_text(encoding="utf-8")


def test_what_bench_cannot_make_sense_of(tmp_path: Path, refused) -> None:
    refused("--only: expected a regular expression, got '('", "bench", "--only", "(")
    refused("cannot be read", "bench", "--compare", tmp_path / "none.json")
    refused("--only: expected part of a name", "bench", "--only", "nothing.of.the.kind")


def test_bench_without_its_extra_says_what_to_install(monkeypatch: pytest.MonkeyPatch, refused) -> None:
    monkeypatch.setitem(sys.modules, "jinja2", None)
    monkeypatch.delitem(sys.modules, "svgf_cl.bench.report", raising=False)
    monkeypatch.delattr("svgf_cl.bench.report", raising=False)
    refused("pip install '.[bench]'", "bench")


def test_a_size_that_no_memory_holds(refused) -> None:
    refused("--size: expected at most 32768 pixels a side", "bench", "--size", "100000x100000")
