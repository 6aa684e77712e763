"""The program, small: it writes its three files and says what it found."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest
from typer.testing import CliRunner

pytest.importorskip("matplotlib")
pytest.importorskip("flip_evaluator")
import typer

from benchmarks import speed_against_error
from benchmarks.variants import Variant
from svgf_cl import Eaw

VARIANTS = (Variant("default", Eaw(iterations=1)), Variant("fast", Eaw(iterations=1, precision="fast")))

APP = typer.Typer()
APP.command()(speed_against_error.speed_against_error)


def test_table_plot_and_json_are_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(speed_against_error, "VARIANTS", VARIANTS)
    short = [replace(footage, frames=3) for footage in speed_against_error.FOOTAGE]
    monkeypatch.setattr(speed_against_error, "FOOTAGE", short)
    arguments = ["-o", str(tmp_path / "out"), "--size", "96x100", "--rounds", "1", "--spp", "32"]
    run = CliRunner().invoke(APP, arguments, catch_exceptions=False)
    assert run.exit_code == 0
    assert {path.name for path in (tmp_path / "out").iterdir()} == {"results.json", "table.md", "plot.png"}
    record = json.loads((tmp_path / "out" / "results.json").read_text())
    assert [each["variant"]["name"] for each in record["results"]] == [variant.name for variant in VARIANTS]
    assert {"device", "svgf_cl", "date", "size", "truth"} == set(record["about"])
    assert set(record["noise"]) == {"area", "centre"}
    assert "1 default" in run.output
    assert "noise of the truth, centre" in (tmp_path / "out" / "table.md").read_text()


def test_half_a_chunk_is_refused(tmp_path: Path) -> None:
    run = CliRunner().invoke(APP, ["-o", str(tmp_path / "out"), "--spp", "100"])
    assert run.exit_code == 2
    assert "multiple of 32" in run.output
    assert not (tmp_path / "out").exists()
