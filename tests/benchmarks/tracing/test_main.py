"""``python -m benchmarks.tracing`` as people use it."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from benchmarks.tracing.__main__ import main
from tests.benchmarks.tracing import made_up

Run = Callable[..., int]


@pytest.fixture
def run(monkeypatch: pytest.MonkeyPatch) -> Run:
    """Exit code of ``python -m benchmarks.tracing argv``."""

    def with_arguments(*argv: str | Path) -> int:
        monkeypatch.setattr(sys, "argv", ["benchmarks.tracing", *map(str, argv)])
        with pytest.raises(SystemExit) as left:
            main()
        return int(left.value.code or 0)

    return with_arguments


@pytest.fixture
def refused(run: Run, capsys: pytest.CaptureFixture[str]) -> Callable[..., None]:
    """Check that a command line is refused: exit code 2 and one line on stderr, with these words and no traceback."""

    def check(words: str, *argv: str | Path) -> None:
        assert run(*argv) == 2
        said = capsys.readouterr().err
        assert said.startswith("tracing: ")
        assert said.count("\n") == 1, said
        assert words in said

    return check


def test_help_has_an_example(run: Run, capsys: pytest.CaptureFixture[str]) -> None:
    assert run("--help") == 0
    said = capsys.readouterr().out
    assert "Usage: python -m benchmarks.tracing [OPTIONS]" in said
    assert "python -m benchmarks.tracing" in said.split("Examples:")[1]


def test_it_writes_and_compares(
    run: Run, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    measured = made_up.tracer_results()
    monkeypatch.setattr("benchmarks.tracing.suite.measure", lambda *_: measured)
    assert run("cornell", "-o", tmp_path) == 0
    assert sorted(path.name for path in tmp_path.iterdir()) == ["results.json", "split.png"]
    shown = capsys.readouterr().out
    for words in ("over raw Embree", "relMSE", "shadow", "G-buffer", "nothing compiled yet", "holds"):
        assert words in shown
    assert run("--compare", tmp_path / "results.json") == 0
    assert "times faster" in capsys.readouterr().out


def test_what_it_cannot_make_sense_of(tmp_path: Path, refused) -> None:
    refused("nowhere: expected a scene's folder or file", "nowhere")
    refused("--size: expected WIDTHxHEIGHT", "--size", "big")
    refused("'--rounds'", "--rounds", "0")
    refused("cannot be read", "--compare", tmp_path / "none.json")


def test_without_an_extra_it_says_what_to_install(monkeypatch: pytest.MonkeyPatch, refused) -> None:
    monkeypatch.setitem(sys.modules, "psutil", None)
    for module in ("suite", "fresh"):
        monkeypatch.delitem(sys.modules, f"benchmarks.tracing.{module}", raising=False)
        monkeypatch.delattr(f"benchmarks.tracing.{module}", raising=False)
    refused("pip install 'svgf-cl[bench]'")
    monkeypatch.setitem(sys.modules, "svgf_cl_tracer.api", None)
    refused("pip install 'svgf-cl[tracer]'")
