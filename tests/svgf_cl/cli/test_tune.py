"""``svgf-cl tune`` as people use it."""

from __future__ import annotations

import json
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import pytest

from svgf_cl import Accumulation, Denoiser
from svgf_cl.bench import tuner
from svgf_cl.device import tuning, user_arrays
from tests.command_line import run


@pytest.fixture(autouse=True)
def store(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Where a quick search stores what it finds, however busy this machine is."""
    monkeypatch.setattr(tuning, "cache_folder", lambda: tmp_path)
    monkeypatch.setattr(tuner, "CHOICES", {"vector_width": (4, 8, 16), "row_alignment": (16, 256)})
    monkeypatch.setattr(tuner, "Denoiser", partial(Denoiser, settings=Accumulation()))  # the quickest to compile
    monkeypatch.setattr(tuner, "STEADY", float("inf"))
    return tmp_path / tuning.STORE


def test_tune_stores_what_it_found(store: Path, capsys: pytest.CaptureFixture[str]) -> None:
    found = store.parent / "tune.json"
    assert run("tune", "--size", "32x18", "--seconds", "1e6", "--json", found) == 0
    assert f"stored in {store}" in capsys.readouterr().out
    written = json.loads(found.read_text())
    assert (written["size"], written["doubts"]) == ("32x18", [])
    default, *others = written["trials"]
    assert default["ms"] > 0
    assert default["values"]["vector_width"] in (4, 8, 16)
    assert len(others) >= 2
    assert run("devices") == 0
    assert "tuned: vectors of" in capsys.readouterr().out
    assert run("tune", "--reset") == 0
    assert run("devices") == 0
    assert "tuned: vectors of" not in capsys.readouterr().out


def test_of_a_search_that_breaks_off_the_file_holds_what_was_tried(tmp_path: Path, monkeypatch) -> None:
    search = tuner.Tuner.search

    def broken(self: tuner.Tuner, advance: Callable[[], None]) -> Any:
        steps = iter(range(3))

        def step() -> None:
            advance()
            if next(steps, None) is None:
                raise KeyboardInterrupt

        return search(self, step)

    monkeypatch.setattr(tuner.Tuner, "search", broken)
    assert run("tune", "--size", "32x18", "--seconds", "1e6", "--json", tmp_path / "tune.json") == 130
    written = json.loads((tmp_path / "tune.json").read_text())
    assert written["verdict"] == "the search is not finished"
    assert len(written["trials"]) >= 2


def test_what_is_not_to_be_stored_is_only_told(store: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run("tune", "--size", "32x18", "--seconds", "1e6", "--no-store") == 0
    assert "not stored, as asked" in capsys.readouterr().out
    assert not store.exists()


def test_where_numpy_arrays_are_copied_the_copies_are_timed(
    store: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(tuner, "shares_memory", lambda device: False)
    monkeypatch.setattr(user_arrays, "shares_memory", lambda device: False)
    monkeypatch.setattr(tuner, "CHOICES", {"vector_width": (4,)})
    monkeypatch.setattr(tuner, "CERTAIN", 0.0)
    for wins in (True, False):  # whatever this machine says
        monkeypatch.setattr(tuner, "WORTHWHILE", float("inf") if wins else 0.0)
        assert run("tune", "--size", "32x18", "--seconds", "1e6") == 0
        said = capsys.readouterr().out
        assert "; calls from numpy to numpy: vectors of" in said
        assert json.loads(store.read_text()).popitem()[1]["tuning"]["pinned_copies"] is wins
        assert (", pinned copies: stored in" in said) is wins


@pytest.mark.parametrize(
    ("seconds", "steady", "reason"),
    [("0", float("inf"), "no time was left for "), ("1e6", -1.0, "the default's own time varies by ")],
)
def test_what_is_in_doubt_is_not_stored(
    seconds: str, steady: float, reason: str, store: Path, monkeypatch: pytest.MonkeyPatch, capsys
) -> None:
    monkeypatch.setattr(tuner, "STEADY", steady)
    assert run("tune", "--size", "32x18", "--seconds", seconds) == 1
    said = capsys.readouterr()
    assert said.err.startswith(f"nothing is stored: {reason}")
    assert said.err.endswith("; make the machine idle or choose a smaller --size, and run it again\n")
    assert said.err.count("\n") == 1
    assert "stored in" not in said.out
    assert not store.exists()
