"""``svgf-cl tune`` as people use it."""

from __future__ import annotations

from pathlib import Path

import pytest

from svgf_cl.bench import tuner
from svgf_cl.device import tuning
from tests.command_line import run


@pytest.fixture(autouse=True)
def store(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Where a quick search stores what it finds, however busy this machine is."""
    monkeypatch.setattr(tuning, "cache_folder", lambda: tmp_path)
    monkeypatch.setattr(tuner, "CHOICES", {"vector_width": (4, 8, 16), "row_alignment": (16, 256)})
    monkeypatch.setattr(tuner, "SECONDS", 1e6)
    monkeypatch.setattr(tuner, "STEADY", float("inf"))
    return tmp_path / tuning.STORE


def test_tune_stores_what_it_found(store: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run("tune", "--size", "32x18") == 0
    assert f"stored in {store}" in capsys.readouterr().out
    assert run("devices") == 0
    assert "tuned: vectors of" in capsys.readouterr().out
    assert run("tune", "--reset") == 0
    assert run("devices") == 0
    assert "tuned: vectors of" not in capsys.readouterr().out


@pytest.mark.parametrize(
    ("constant", "value", "reason"),
    [("SECONDS", 0.0, "no time was left for "), ("STEADY", -1.0, "the default's own time wavers by ")],
)
def test_what_is_in_doubt_is_not_stored(
    constant: str, value: float, reason: str, store: Path, monkeypatch: pytest.MonkeyPatch, capsys
) -> None:
    monkeypatch.setattr(tuner, constant, value)
    assert run("tune", "--size", "32x18") == 1
    said = capsys.readouterr()
    assert said.err.startswith(f"nothing is stored: {reason}")
    assert said.err.endswith("; make the machine idle or choose a smaller --size, and run it again\n")
    assert said.err.count("\n") == 1
    assert "stored in" not in said.out
    assert not store.exists()
