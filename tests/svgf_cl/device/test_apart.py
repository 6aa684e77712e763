"""A process that is asked answers, or is said not to have answered, and how."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from svgf_cl.device import apart

POCL_3_0 = """clBuildProgram failed: BUILD_PROGRAM_FAILURE - clBuildProgram failed: BUILD_PROGRAM_FAILURE

Build on <pyopencl.Device 'pthread-AMD EPYC' on 'Portable Computing Language' at 0x55977fd71760>:

error: unknown target CPU 'generic'
Device pthread-AMD EPYC failed to build the program

(options: -I /tmp/lib/python3.11/site-packages/pyopencl/cl)"""


def ask(script: str) -> str:
    return apart.ask(["/bin/sh", "-c", script], os.environ)


@pytest.mark.parametrize(
    ("script", "reason"),
    [
        ("kill -SEGV $$", "the driver crashes (SIGSEGV): the driver gives no reason"),
        ("echo 'LLVM ERROR: broken' >&2; kill -ABRT $$", "the driver crashes (SIGABRT): LLVM ERROR: broken"),
        ("echo 'no such module' >&2; exit 3", "the probe fails: no such module"),
        ("true", "the probe fails: the driver gives no reason"),
        ("exec sleep 60", "the driver hangs: no answer within 0.5 s"),
    ],
    ids=["segfault", "abort", "exit", "silent", "hang"],
)
def test_a_driver_that_misbehaves_gives_no_answer(script: str, reason: str, monkeypatch: pytest.MonkeyPatch) -> None:
    if "sleep" in script:
        monkeypatch.setattr(apart, "TIMEOUT_SECONDS", 0.5)
    with pytest.raises(apart.NoAnswerError) as error:
        ask(script)
    assert str(error.value) == reason


def test_a_process_that_cannot_be_started_gives_no_answer(tmp_path: Path) -> None:
    with pytest.raises(apart.NoAnswerError, match=r"the probe cannot be started: .*Permission denied"):
        apart.ask([str(tmp_path)], os.environ)


def test_a_driver_that_prints_before_and_after_the_answer() -> None:
    assert ask(f"echo hello from the driver; echo '{apart.answer('says no')}'; echo bye") == "says no"


@pytest.mark.parametrize(
    ("log", "line"),
    [
        (POCL_3_0, "error: unknown target CPU 'generic'"),
        ("clCreateContext failed: OUT_OF_HOST_MEMORY", "clCreateContext failed: OUT_OF_HOST_MEMORY"),
        ("a\nb\n\n", "b"),
        ("", "the driver gives no reason"),
    ],
)
def test_summary(log: str, line: str) -> None:
    assert apart.summary(log) == line
