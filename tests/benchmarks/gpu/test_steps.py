"""The steps fit into ten minutes, name tests that there are, and say why they have no result."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from benchmarks.gpu import child, findings, steps
from benchmarks.gpu.child import Ended

ROOT = Path(__file__).parents[3]
FOLDER = Path("out")
COLLECT = ("--collect-only", "-q", "-p", "no:cacheprovider", "-p", "no:faulthandler")


def test_all_steps_end_within_ten_minutes() -> None:
    assert sum(step.seconds + child.GRACE + child.DYING for step in steps.full(FOLDER)) <= steps.LONGEST


def test_a_dry_run_takes_the_same_steps() -> None:
    full, dry = steps.full(FOLDER), steps.dry(FOLDER)
    assert [(step.name, step.read, step.result, step.command[0]) for step in full] == [
        (step.name, step.read, step.result, step.command[0]) for step in dry
    ]
    assert len({step.name for step in full}) == len(full)


def test_a_dry_run_keeps_no_tuning() -> None:
    commands = {step.name: step.command for step in steps.dry(FOLDER)}
    assert "--no-store" in commands["tune"]


@pytest.mark.parametrize("plan", [steps.full, steps.dry])
def test_the_tests_that_are_chosen_are_there(plan, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)
    for step in plan(FOLDER):
        if step.command[0] == "pytest":
            chosen = [word for word in step.command[len(steps.PYTEST) :] if not word.startswith("--junitxml")]
            assert pytest.main([*COLLECT, *chosen]) == 0


def step(result: Path) -> steps.Step:
    return steps.Step("a", "a step", (), 30, result, findings.tune)


@pytest.mark.parametrize(
    ("ended", "complaint"),
    [
        (Ended(None, 30.0, "", ""), "no result within 30 s; it was stopped"),
        (Ended(1, 1.0, "", "Traceback\nOSError: no such device\n"), "exit code 1: OSError: no such device"),
        (Ended(-11, 1.0, "said", ""), "exit code -11: said"),
    ],
)
def test_a_step_without_a_result_says_why(ended: Ended, complaint: str, tmp_path: Path) -> None:
    assert step(tmp_path / "missing.json").found(ended).complaint == complaint


@pytest.mark.parametrize("text", ["", "{}", "[]"])
def test_a_result_that_is_none_is_no_result(text: str, tmp_path: Path) -> None:
    (tmp_path / "tune.json").write_text(text)
    found = step(tmp_path / "tune.json").found(Ended(0, 1.0, "", ""))
    assert found.complaint.startswith("its result cannot be read (")


def test_half_a_junit_file_is_no_result(tmp_path: Path) -> None:
    (tmp_path / "tests.xml").write_text("<testsuites>")
    cut = replace(step(tmp_path / "tests.xml"), read=findings.tests)
    assert cut.found(Ended(0, 1.0, "", "")).complaint.startswith("its result cannot be read (")


def test_what_an_earlier_run_left_is_not_taken_for_a_result(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "tune.json").write_text('{"size": "1x1", "verdict": "", "doubts": [], "trials": []}')
    monkeypatch.setattr(child, "run", lambda *_: Ended(1, 0.0, "", "it crashed"))
    _, found = steps.run(step(tmp_path / "tune.json"), tmp_path, {}, lambda _: None)
    assert found.complaint == "exit code 1: it crashed"


def test_the_page_lists_the_steps_with_their_limits() -> None:
    lines = (ROOT / "docs" / "gpu.md").read_text().splitlines()
    for step in steps.full(FOLDER):
        assert any(line.startswith(f"| `{step.name}` |") and line.endswith(f"| {step.seconds} s |") for line in lines)
