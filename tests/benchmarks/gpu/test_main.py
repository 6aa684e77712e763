"""A run goes on after a step that fails, and leaves with exit code 1; what a user can get wrong, with 2."""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path

import pytest

from benchmarks.gpu import __main__ as run
from benchmarks.gpu import choice, findings, steps
from benchmarks.gpu.child import Ended
from benchmarks.gpu.findings import Found
from benchmarks.gpu.steps import Step
from svgf_cl.device import devices


@pytest.fixture
def leave(monkeypatch: pytest.MonkeyPatch, tmp_path: Path):
    """A function that runs the command with these arguments, and returns its exit code."""
    monkeypatch.setenv(devices.VARIABLE, "to be restored")
    monkeypatch.delenv(devices.VARIABLE)

    def leave(*arguments: str) -> int:
        monkeypatch.setattr(sys, "argv", ["benchmarks.gpu", "-o", str(tmp_path / "gpu"), *arguments])
        with pytest.raises(SystemExit) as left:
            run.main()
        return int(left.value.code or 0)

    return leave


@pytest.fixture
def made_up(monkeypatch: pytest.MonkeyPatch) -> list[tuple[str, str]]:
    """Three steps, of which the second fails; what is asked of them, and of which device."""
    asked: list[tuple[str, str]] = []

    def plan(folder: Path) -> list[Step]:
        return [Step(name, name, (), 1, folder / name, findings.tune) for name in ("one", "two", "three")]

    def take(step: Step, folder: Path, environment: dict[str, str], tick) -> tuple[Ended, Found]:
        asked.append((step.name, environment[devices.VARIABLE]))
        tick(0.5)
        assert len(json.loads((folder / "report.json").read_text())["steps"]) == len(asked) - 1
        return Ended(0, 0.1, "", ""), Found(complaint="it crashed" if step.name == "two" else "")

    monkeypatch.setattr(steps, "dry", plan)
    monkeypatch.setattr(steps, "run", take)
    return asked


def test_a_step_that_fails_does_not_stop_the_others(leave, made_up, tmp_path: Path, capsys) -> None:
    assert leave("--dry-run") == 1
    chosen = choice.chosen(devices.list_devices(), dry_run=True).selector
    assert made_up == [("one", chosen), ("two", chosen), ("three", chosen)]
    said = capsys.readouterr()
    assert "failed: two" in said.err
    assert "it crashed" in said.out
    steps_found = json.loads((tmp_path / "gpu" / "report.json").read_text())["steps"]
    assert [each["state"] for each in steps_found] == ["done", "failed", "done"]


def test_the_device_that_is_named_is_used(leave, made_up) -> None:
    named = [each for each in devices.list_devices() if each.works][-1]
    assert leave("--dry-run", "--device", named.selector) == 1
    assert {device for _, device in made_up} == {named.selector}
    assert os.environ[devices.VARIABLE] == named.selector


def test_without_a_gpu_nothing_is_done(leave, monkeypatch, tmp_path: Path, capsys) -> None:
    found = [report for report in devices.list_devices() if report.kind not in choice.KINDS]
    monkeypatch.setattr(devices, "list_devices", lambda *, refresh: found)
    assert leave() == 2
    said = capsys.readouterr().err
    assert said.startswith("gpu: no GPU works with OpenCL. These devices were found:\n")
    assert "--dry-run" in said
    assert not (tmp_path / "gpu").exists()


def test_a_name_that_names_none_is_refused(leave, capsys) -> None:
    assert leave("--dry-run", "--device", "no such device") == 2
    assert "'no such device' names no device" in capsys.readouterr().err
