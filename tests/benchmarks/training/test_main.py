"""Training as a command: it writes a network that is better than none, and resumes to the same numbers."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import typer
from typer.testing import CliRunner

pytest.importorskip("embreex")
pytest.importorskip("numba")

from benchmarks.training import __main__ as training
from svgf_cl.filters.lbf import Network
from svgf_cl.io.atomic import read_json

APP = typer.Typer()
APP.command()(training.train)
TINY = ("--rooms", "1", "--pixels", "300", "--size", "48x32", "--spp", "16")


def run(target: Path, rounds: int) -> dict[str, object]:
    """Train, and read what was written."""
    found = CliRunner().invoke(APP, [*TINY, "--rounds", str(rounds), "-o", str(target)], catch_exceptions=False)
    assert found.exit_code == 0
    record: dict[str, object] = read_json(target)
    return record


@pytest.fixture
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    """One room to judge by, and few steps."""
    monkeypatch.setattr(training, "HELD_OUT", range(10_000, 10_001))
    monkeypatch.setattr(training, "STEPS", 3)


def test_a_run_that_broke_off_ends_with_the_same_numbers(
    tmp_path: Path, quick: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = run(tmp_path / "whole.json", 2)
    errors = whole["about"]["error on held-out scenes"]["rooms"]  # type: ignore[index]
    assert errors["LBF"] < errors["accumulated"]
    assert len(whole["about"]["error of each round"]) == 2  # type: ignore[index]
    assert np.isfinite(Network.of(whole["network"]).flat()).all()  # type: ignore[arg-type]

    broken = tmp_path / "broken.json"
    written = []

    def kill(path: Path, record: object) -> None:
        written.append(path)
        path.write_text(json.dumps(record))
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(training, "write_json", kill)
        CliRunner().invoke(APP, [*TINY, "--rounds", "2", "-o", str(broken)])
    assert written == [broken.with_suffix(".part")]
    assert not broken.exists()
    assert run(broken, 2)["network"] == whole["network"]
    assert not broken.with_suffix(".part").exists()


def test_another_course_begins_anew(tmp_path: Path) -> None:
    courses = [training.Course(1, rounds, 300, "48x32", 16, ()) for rounds in (2, 3)]
    begun = training.Progress(training.jsonable(courses[0]), [0.5], 1.0, [0.0])
    training.write_json(tmp_path / "a.part", training.asdict(begun))
    assert training.resumed(tmp_path / "a.part", courses[0]) == begun
    assert training.resumed(tmp_path / "a.part", courses[1]).errors == []
