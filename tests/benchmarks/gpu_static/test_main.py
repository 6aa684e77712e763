"""The command: what it writes, and when it fails."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import pytest
import typer
from typer.testing import CliRunner, Result

from benchmarks.builds import Build
from benchmarks.gpu_static import __main__ as command
from benchmarks.gpu_static.gate import Outcome, Row
from tests.benchmarks.gpu_static.made_up import row

APP = typer.Typer()
APP.command()(command.gpu_static)
VERSIONS = {"clang": "19.1.7"}
ROWS = [row("atrous", "sm_90", 64), row("atrous", "gfx1100", 48)]
GOOD = {"atrous/atrous": {"sm_90": 64, "gfx1100": 48}}

Run = Callable[..., Result]


@pytest.fixture
def run(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Run:
    """Run the command with rows that no compiler made, and budgets of its own."""
    budgets = tmp_path / "budgets.json"

    def run(
        *arguments: str, rows: list[Row] = ROWS, recorded: object = GOOD, versions: object = VERSIONS, fault: str = ""
    ) -> Result:
        budgets.write_text(json.dumps({"compilers": versions, **recorded}))  # type: ignore[dict-item]
        build = Build("atrous", (), "any")
        monkeypatch.setattr(command.budgets, "FILE", budgets)
        monkeypatch.setattr(command.tools, "find", lambda: SimpleNamespace(versions=VERSIONS))
        monkeypatch.setattr(command.variants, "variants", lambda: [build])
        monkeypatch.setattr(command.gate, "compile_all", lambda *_: [Outcome(build, "sm_90", fault=fault)])
        monkeypatch.setattr(command.gate, "rows", lambda *_: rows)
        return CliRunner().invoke(APP, ["-o", str(tmp_path / "out"), *arguments])

    return run


def test_what_keeps_its_budgets_passes_and_is_written(run: Run, tmp_path: Path) -> None:
    result = run()
    assert result.exit_code == 0, result.output
    assert {path.name for path in (tmp_path / "out").iterdir()} == {"kernels.json", "kernels.md", "summary.md"}
    assert json.loads((tmp_path / "out" / "kernels.json").read_text())["about"]["clang"] == "19.1.7"
    assert "| atrous/atrous |  | 64, 50%, 100 |  | 48, 100%, 100 |  |" in (tmp_path / "out" / "summary.md").read_text()


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"recorded": {"atrous/atrous": {"sm_90": 63, "gfx1100": 48}}}, "expected at most 63 registers, found 64"),
        ({"recorded": {}}, "expected a budget"),
        ({"rows": ROWS[:1]}, "expected a kernel, found a budget"),
        ({"rows": [*ROWS, row("atrous", "sm_90", 64, spills=1)]}, "expected no registers spilled"),
        ({"rows": [*ROWS, row("atrous", "sm_90", 64, scratch=4)]}, "expected no scratch memory"),
        ({"fault": "expected a valid module"}, "expected a valid module"),
    ],
)
def test_what_is_wrong_is_told_and_fails(run: Run, given: dict[str, object], said: str) -> None:
    result = run(**given)
    assert result.exit_code == 1
    assert said in result.output


def test_other_compilers_are_told_where_something_fails(run: Run) -> None:
    other = {"clang": "21.1.0"}
    assert run(versions=other).exit_code == 0
    result = run(versions=other, recorded={})
    assert "clang 19.1.7 is not 21.1.0" in result.output


def test_budgets_are_recorded_unless_something_does_not_compile(run: Run, tmp_path: Path) -> None:
    grown = [row("atrous", "sm_90", 96)]
    assert run("--record", rows=grown).exit_code == 0
    assert json.loads((tmp_path / "budgets.json").read_text())["atrous/atrous"] == {"sm_90": 96}
    assert run("--record", rows=grown, fault="expected kernels that compile").exit_code == 1
    assert json.loads((tmp_path / "budgets.json").read_text())["atrous/atrous"] == GOOD["atrous/atrous"]


def test_recording_budgets_does_not_forgive_spills(run: Run) -> None:
    result = run("--record", rows=[row("atrous", "sm_90", 96, spills=1)])
    assert result.exit_code == 1
    assert "expected no registers spilled" in result.output


def test_of_many_faults_the_first_are_shown(run: Run) -> None:
    many = [row("atrous", "sm_90", 64, variant=str(number), spills=1) for number in range(command.SHOWN + 5)]
    result = run(rows=[*ROWS, *many])
    assert f"{command.SHOWN + 5} faults" in result.output
    assert "and 5 more" in result.output
