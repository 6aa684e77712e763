"""Lines of progress, as farms read them."""

from __future__ import annotations

import re

import pytest

from svgf_cl.cli import log
from svgf_cl.cli.console import progress_bar, share_bar, tracked


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """The time, to be changed."""
    now = [100.0]
    monkeypatch.setattr(log, "monotonic", lambda: now[0])
    monkeypatch.setattr(log, "SECONDS", 10.0)
    monkeypatch.delenv(log.OPENJD, raising=False)
    return now


def counted(clock: list[float], frames: int, seconds: float) -> None:
    """Go through frames that take so many seconds each."""
    for _ in tracked(range(frames), frames, "denoising"):
        clock[0] += seconds


def test_a_line_now_and_then_with_the_share_and_the_time_left(clock: list[float], capsys) -> None:
    counted(clock, 8, 6.0)
    assert capsys.readouterr().err.splitlines() == [
        "Progress: 25% denoising 2 of 8, 0:00:36 left",
        "Progress: 50% denoising 4 of 8, 0:00:24 left",
        "Progress: 75% denoising 6 of 8, 0:00:12 left",
        "Progress: 100% denoising 8 of 8, 0:00:00 left",
    ]


def test_what_takes_little_time_says_nothing(clock: list[float], capsys) -> None:
    counted(clock, 8, 1.0)
    counted(clock, 0, 1.0)
    assert not capsys.readouterr().err


def test_under_open_job_description_lines_are_its_own(
    clock: list[float], monkeypatch: pytest.MonkeyPatch, capsys
) -> None:
    monkeypatch.setenv(log.OPENJD, "folder")
    counted(clock, 8, 11.0)
    said = capsys.readouterr().err.splitlines()
    assert said[:2] == ["openjd_progress: 12.5", "openjd_status: denoising 1 of 8, 0:01:17 left"]
    assert all(re.fullmatch(r"openjd_(progress: [0-9.]+|status: .+)", line) for line in said)


def test_the_time_left_is_judged_by_what_this_run_did(clock: list[float], capsys) -> None:
    with share_bar("references", 4) as report:
        for done in (2.0, 2.0, 2.5):
            report(done, "32 spp")
            clock[0] += 15.0
    assert capsys.readouterr().err == "Progress: 62% references 2 of 4, 32 spp, 0:01:30 left\n"


def test_nothing_to_do_is_no_error(clock: list[float], capsys) -> None:
    with progress_bar("nothing", 0):
        clock[0] += 60.0
    assert not capsys.readouterr().err


def test_a_closed_stderr_is_no_error(clock: list[float], monkeypatch: pytest.MonkeyPatch, capsys) -> None:
    monkeypatch.setattr("sys.stderr", None)
    counted(clock, 2, 60.0)
    assert not capsys.readouterr().out
