"""All that is measured is in one report, and what is missing is named there."""

from __future__ import annotations

from pathlib import Path

import pytest
from typer.testing import CliRunner

pytest.importorskip("matplotlib")
pytest.importorskip("flip_evaluator")
import typer

from benchmarks import __main__ as everything
from benchmarks import speed_against_error, versus_oidn
from benchmarks.measurements import Quality
from benchmarks.tracing import suite as tracing
from benchmarks.versus_oidn import Comparison
from svgf_cl import SvgfError
from svgf_cl.bench import report
from svgf_cl.bench.results import Result, Run
from svgf_cl.bench.rig import HOST
from svgf_cl.bench.suite import Suite
from svgf_cl.compare import oidn
from tests.benchmarks.test_findings import FINDINGS
from tests.benchmarks.tracing.made_up import tracer_results
from tests.svgf_cl.bench.runs import whole_run

APP = typer.Typer()
APP.command()(everything.everything)

TIMES = {("svgf_cl 5x5", HOST): [0.01], ("svgf_cl 5x5", "event"): [0.01], ("OIDN high", HOST): [0.2]}
RACE = Comparison(
    TIMES,
    {"svgf_cl 5x5": 1, "OIDN high": 1},
    {"svgf_cl 5x5": Quality(1, 1, 1, 1)},
    {"OIDN": "2.5"},
    tuple(
        Result("race", "0:0", clock, tuple(seconds), {"race": name, "width": 1280, "height": 720})
        for (name, clock), seconds in TIMES.items()
    ),
)


@pytest.fixture(autouse=True)
def _measured(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing is timed."""
    monkeypatch.setattr(Suite, "run", lambda *_: whole_run())
    monkeypatch.setattr(oidn, "require_oidn", lambda: None)
    monkeypatch.setattr(versus_oidn, "compared", lambda *_: RACE)
    monkeypatch.setattr(tracing, "measure", lambda *_: tracer_results())
    monkeypatch.setattr(speed_against_error, "found", lambda *_: FINDINGS)


def test_one_report_holds_all(tmp_path: Path) -> None:
    run = CliRunner().invoke(APP, ["-o", str(tmp_path)], catch_exceptions=False)
    page = (tmp_path / "report.html").read_text()
    for title in ("Bars", "Benchmarks", versus_oidn.TITLE, "The tracer: box", "Speed against error"):
        assert f"<h2>{title}</h2>" in page
    assert "bar: 5x5 faster than OIDN high" in page
    assert "bar: 5x5 faster than OIDN high" in run.output
    assert "raw Embree" in run.output
    assert "the tracer&#39;s memory" in page
    names = {result.name for result in Run.read(tmp_path / "results.json").results}
    assert {"race", "tracer.frame.1280x720"} <= names
    assert (tmp_path / "speed-against-error" / "table.md").exists()


def test_without_oidn_the_report_says_so(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def missing() -> None:
        raise SvgfError("Open Image Denoise is missing")

    monkeypatch.setattr(oidn, "require_oidn", missing)
    monkeypatch.setattr(report, "inline_svg", lambda *_: "")  # the other test has all plots
    CliRunner().invoke(APP, ["-o", str(tmp_path)], catch_exceptions=False)
    page = (tmp_path / "report.html").read_text()
    assert "Open Image Denoise is missing" in page
    assert "Speed against error" in page
