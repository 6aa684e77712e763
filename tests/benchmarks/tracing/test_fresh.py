"""A new process says how it started and what it held."""

from __future__ import annotations

from pathlib import Path

import pytest

from benchmarks.tracing import fresh
from benchmarks.tracing.fresh import STARTS, Fresh, in_new_process, starts
from svgf_cl import SvgfError
from svgf_cl_tracer.compiled import FOLDER
from tests.benchmarks.tracing.made_up import WARM


def test_a_new_process() -> None:
    caches = FOLDER.parents[2]  # the user's, where it is all compiled
    found = in_new_process("cornell", (90, 160), caches)
    assert found.load >= found.trees > 0.0
    assert found.first > 0.0
    assert 0 < found.libraries < found.peak
    assert found.peak > 90 * 160 * 4 * 31, "the frame's own arrays"


def test_a_process_that_fails_is_told(tmp_path: Path) -> None:
    with pytest.raises(SvgfError, match=r"(?s)nowhere: a new process could not render it:.*Traceback"):
        in_new_process("nowhere", (9, 16), tmp_path)


def test_only_the_first_start_finds_an_empty_cache(monkeypatch: pytest.MonkeyPatch) -> None:
    folders: list[Path] = []
    contents: list[int] = []

    def start(_: str, shape: tuple[int, int], caches: Path) -> Fresh:
        folders.append(caches)
        contents.append(len(list(caches.iterdir())))
        (caches / str(len(folders))).touch()
        return WARM

    monkeypatch.setattr(fresh, "in_new_process", start)
    ticks: list[int] = []
    assert starts("cornell", (9, 16), lambda: ticks.append(1)) == [WARM] * STARTS
    assert contents == list(range(STARTS))
    assert len(set(folders)) == 1
    assert not folders[0].exists()
    assert len(ticks) == STARTS
