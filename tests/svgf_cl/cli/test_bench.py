"""``svgf-cl bench`` as people use it."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from pathlib import Path
from xml.etree import ElementTree

import pytest

from svgf_cl.bench.results import Run
from svgf_cl.device import devices
from tests.command_line import run
from tests.svgf_cl.bench import runs as made_up


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
    refused("pip install 'svgf-cl[bench]'", "bench")


def test_a_size_that_no_memory_holds(refused) -> None:
    refused("--size: expected at most 32768 pixels a side", "bench", "--size", "100000x100000")


class FakeSuite:
    """In place of `Suite`: takes the run that it is given for the one that was timed."""

    timed: Run

    def __init__(self, *_: object) -> None:
        pass

    def run(self, _: object) -> Run:
        return self.timed


@pytest.fixture
def before(tmp_path: Path) -> Path:
    """An earlier run in which every frame took 10 ms."""
    made_up.run(made_up.result("frame", "event", 10.0, 10.0, 10.0)).write(tmp_path / "before.json")
    return tmp_path / "before.json"


@pytest.fixture
def now(monkeypatch: pytest.MonkeyPatch) -> Callable[..., None]:
    """Let `bench` find samples in milliseconds of a row, by default of the frame."""
    monkeypatch.setattr("svgf_cl.bench.suite.Suite", FakeSuite)

    def timed(*ms: float, row: str = "frame") -> None:
        FakeSuite.timed = made_up.run(made_up.result(row, "event", *ms), left_out=("svgf.frame.9x9: no room",))

    return timed


def test_the_gate_stops_what_became_slower(
    before: Path, now, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    now(12.0, 12.0, 12.0)
    assert run("bench", "--compare", before, "--fail-above", "1.10", "--junit", tmp_path / "new" / "junit.xml") == 1
    line = "Alpha, svgf.frame.1280x720: 10.00 ms before, 12.00 ms now (event time), 1.20 times as long\n"
    assert capsys.readouterr().err == line
    (failure,) = ElementTree.parse(tmp_path / "new" / "junit.xml").getroot().iter("failure")
    assert failure.attrib["message"] in line


def test_the_gate_lets_pass_what_did_not(before: Path, now, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    now(10.5, 10.5, 10.5)
    assert run("bench", "--compare", before, "--fail-above", "1.10", "--junit", tmp_path / "junit.xml") == 0
    assert capsys.readouterr().err == ""
    (suite,) = ElementTree.parse(tmp_path / "junit.xml").getroot()
    assert (suite.attrib["name"], suite.attrib["tests"], suite.attrib["failures"]) == ("svgf-cl bench", "1", "0")


def test_without_a_gate_nothing_stops(before: Path, now) -> None:
    now(99.0)
    assert run("bench", "--compare", before) == 0


def test_a_gate_without_what_it_needs_is_refused(before: Path, now, tmp_path: Path, refused) -> None:
    refused("--fail-above: expected --compare OLD.json too", "bench", "--fail-above", "1.1")
    refused("--junit: expected --fail-above RATIO too", "bench", "--compare", before, "--junit", "a.xml")
    for ratio in ("0", "-1", "nan", "inf"):
        refused("'--fail-above': expected a ratio > 0", "bench", "--compare", before, f"--fail-above={ratio}")
    now(1.0, row="temporal")
    gate = ("bench", "--compare", before, "--fail-above", "1.1")
    refused("--fail-above: expected the runs to share a pass or a frame", *gate, "--junit", tmp_path / "junit.xml")
    assert not (tmp_path / "junit.xml").exists()


@pytest.mark.parametrize("option", ["--json", "--junit"])
def test_where_nothing_can_be_written_nothing_is_timed(option: str, before: Path, now, tmp_path: Path, refused) -> None:
    refused("expected a file to write, got a folder", "bench", "--compare", before, "--fail-above=2", option, tmp_path)


def test_json_on_stdout_stands_alone(before: Path, now, capsys: pytest.CaptureFixture[str]) -> None:
    now(12.0, 12.0, 12.0)
    assert run("bench", "--json", "-", "--compare", before, "--fail-above", "1.1") == 1
    said = capsys.readouterr()
    assert json.loads(said.out)["benchmarks"][0]["name"] == "svgf.frame.1280x720"
    assert said.err.startswith("left out: svgf.frame.9x9: no room\n")
    assert "1.20 times as long" in said.err


def test_json_in_a_file_and_a_report_beside_it(now, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    now(12.0)
    assert run("bench", "--json", tmp_path / "new" / "a.json", "-o", tmp_path / "report") == 0
    assert Run.read(tmp_path / "new" / "a.json") == Run.read(tmp_path / "report" / "results.json")
    assert "svgf.frame.1280x720" in capsys.readouterr().out, "tables as ever"


@pytest.mark.usefixtures("quick_ceilings")
def test_a_list_runs_nothing(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], refused) -> None:
    monkeypatch.setattr("svgf_cl.bench.suite.Station", None)
    argv = ("bench", "--list", "--filter", "svgf", "--set", "iterations=2", "--size", "16x9")
    assert run(*argv, "--only", r"atrous\.|numpy") == 0
    assert capsys.readouterr().out.split() == [
        "svgf.atrous.1.16x9",
        "svgf.atrous.2.16x9",
        "svgf.atrous.16x9",
        "svgf.frame.numpy.16x9",
    ]
    refused("--only: expected part of a name", *argv, "--only", "nothing.of.the.kind")


@pytest.mark.usefixtures("quick_ceilings")
def test_without_ceilings_no_rooflines(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    argv = ("bench", "--no-ceilings", "--only", "frame.16x9", "--size", "16x9", "--seconds", "0", "-o", tmp_path)
    assert run(*argv) == 0
    shown = capsys.readouterr().out
    assert "kalman.frame.16x9" in shown
    assert "roofline" not in shown
    assert "GFLOP" not in shown
    assert "ceiling." not in (tmp_path / "results.json").read_text(encoding="utf-8")
