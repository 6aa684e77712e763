"""A process that crashes, hangs or leaves others behind is ended, and what it said is kept."""

from __future__ import annotations

import os
import signal
import time
from pathlib import Path

import pytest

from benchmarks.gpu import child
from benchmarks.gpu.child import Ended

KEPT = """
import time
try:
    print("begun", flush=True)
    time.sleep(600)
except KeyboardInterrupt:
    print("kept")
"""
PARENT = """
import subprocess, sys
child = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(600)"])
open(PIDS, "w").write(str(child.pid))
"""
HANG = "import signal, time; signal.signal(signal.SIGINT, signal.SIG_IGN); print('here', flush=True); time.sleep(600)"


@pytest.fixture
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """A function that runs lines of Python as a step's module."""
    monkeypatch.setattr(child, "GRACE", 0.5)

    def run(code: str, seconds: float = 60.0, tick=lambda _: None) -> Ended:
        (tmp_path / "a_step.py").write_text(code)
        environment = os.environ | {"PYTHONPATH": str(tmp_path)}
        return child.run(["a_step"], seconds, (tmp_path / "out", tmp_path / "err"), environment, tick)

    return run


def test_what_it_says_and_its_exit_code_are_kept(run) -> None:
    ticks: list[float] = []
    ended = run("import sys, time; print('said'); time.sleep(0.3); sys.exit('wrong')", tick=ticks.append)
    assert (ended.code, ended.output, ended.errors) == (1, "said\n", "wrong\n")
    assert not ended.is_short
    assert ticks
    assert ticks == sorted(ticks)


def test_a_crash_is_told_by_the_signal(run) -> None:
    assert run("import os, signal; os.kill(os.getpid(), signal.SIGABRT)").code == -signal.SIGABRT


def test_at_its_limit_it_may_write_what_it_knows(run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(child, "GRACE", 60.0)  # it ends long before, unless the machine is very busy
    ended = run(KEPT, seconds=2.0)
    assert ended.is_short
    assert ended.output == "begun\nkept\n"


def test_it_listens_even_if_this_process_ignores_interrupts(run, monkeypatch: pytest.MonkeyPatch) -> None:
    """As does all that a shell runs in the background of a script."""
    monkeypatch.setattr(child, "GRACE", 60.0)
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        assert run(KEPT, seconds=1.0).output == "begun\nkept\n"
    finally:
        signal.signal(signal.SIGINT, before)


def test_one_that_does_not_listen_is_killed_with_what_it_has_started(run, tmp_path: Path) -> None:
    pids = tmp_path / "pids"
    ended = run(f"PIDS = {str(pids)!r}{PARENT}{HANG}", seconds=2.0)
    assert ended.is_short
    assert ended.output == "here\n"
    grandchild = int(pids.read_text())
    for _ in range(100):
        if not is_running(grandchild):
            break
        time.sleep(0.05)
    assert not is_running(grandchild)


def is_running(process: int) -> bool:
    """Whether it does anything yet; one that nobody has waited for does not."""
    try:
        return "\nState:\tZ" not in Path(f"/proc/{process}/status").read_text()
    except OSError:
        return False
