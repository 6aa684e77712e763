"""The probe on a real device, on one that cannot be used, and what it remembers."""

from __future__ import annotations

import sys

import pytest

from svgf_cl import probe

KEY = "some device"

POCL_3_0 = """clBuildProgram failed: BUILD_PROGRAM_FAILURE - clBuildProgram failed: BUILD_PROGRAM_FAILURE

Build on <pyopencl.Device 'pthread-AMD EPYC' on 'Portable Computing Language' at 0x55977fd71760>:

error: unknown target CPU 'generic'
Device pthread-AMD EPYC failed to build the program

(options: -I /tmp/lib/python3.11/site-packages/pyopencl/cl)"""


@pytest.fixture
def memory(monkeypatch, tmp_path):
    """An empty cache folder."""
    folder = tmp_path / "cache"
    monkeypatch.setattr(probe, "cache_folder", lambda: folder)
    return folder


@pytest.fixture
def answers(monkeypatch):
    """The answers that the next probes give, first first; probing more often fails."""
    given: list[str] = []
    monkeypatch.setattr(probe, "_run_apart", lambda key: given.pop(0))
    monkeypatch.setattr(probe, "key", lambda device: KEY)
    return given


@pytest.fixture
def interpreter(monkeypatch, tmp_path):
    """A function that puts a shell script in Python's place."""

    def replace(script: str) -> None:
        path = tmp_path / "python"
        path.write_text(f"#!/bin/sh\n{script}\n")
        path.chmod(0o755)
        monkeypatch.setattr(sys, "executable", str(path))

    return replace


def test_working_device(queue, memory):
    assert probe.run(queue.device) == ""
    assert probe.reason(queue.device) == ""
    assert probe.key(queue.device) in (memory / probe.MEMORY).read_text()


def test_wrong_numbers(queue, monkeypatch):
    monkeypatch.setattr(probe, "KERNEL", probe.KERNEL.replace("sqrt", ""))
    assert probe.run(queue.device) == "computes wrong numbers"


def test_broken_compiler(queue, monkeypatch):
    monkeypatch.setattr(probe, "KERNEL", "#error no such CPU")
    reason = probe.run(queue.device)
    assert "no such CPU" in reason
    assert "\n" not in reason


@pytest.mark.parametrize(
    ("script", "reason"),
    [
        ("kill -SEGV $$", "the driver crashes (SIGSEGV): the driver gives no reason"),
        ("echo 'LLVM ERROR: broken' >&2; kill -ABRT $$", "the driver crashes (SIGABRT): LLVM ERROR: broken"),
        ("echo 'no such module' >&2; exit 3", "the probe fails: no such module"),
        ("""echo 'hello from the driver'; echo '"says no"'""", "says no"),
        ("exec sleep 60", "the driver hangs: no answer within 0.5 s"),
    ],
    ids=["segfault", "abort", "exit", "chatty", "hang"],
)
def test_a_driver_that_misbehaves_is_an_answer(interpreter, monkeypatch, script, reason):
    if "sleep" in script:
        monkeypatch.setattr(probe, "TIMEOUT_SECONDS", 0.5)
    interpreter(script)
    assert probe._run_apart(KEY) == reason


def test_a_device_that_only_this_process_lists(queue):
    assert "not listed" in probe._run_apart("no such device")


def test_answers_are_remembered(memory, answers):
    answers += ["broken", "never asked"]
    assert probe.reason(None) == probe.reason(None) == "broken"


def test_refresh_doubts_only_what_is_broken(memory, answers):
    answers += ["broken", "", "never asked"]
    assert probe.reason(None) == "broken"
    assert probe.reason(None, refresh=True) == ""
    assert probe.reason(None, refresh=True) == ""


def test_a_new_driver_is_probed_anew(queue):
    class Updated:
        name = queue.device.name
        platform = queue.device.platform
        driver_version = queue.device.driver_version + ".1"

    assert probe.key(Updated) != probe.key(queue.device)


def test_a_damaged_memory_is_written_anew(memory, answers):
    memory.mkdir()
    (memory / probe.MEMORY).write_text('{"some dev')
    answers += ["", "never asked"]
    assert probe.reason(None) == probe.reason(None) == ""


def test_a_memory_that_cannot_be_written_is_not_silent(memory, answers):
    memory.write_text("a file where the folder should be")
    answers.append("")
    with pytest.warns(UserWarning, match="in every run"):
        assert probe.reason(None) == ""


@pytest.mark.parametrize(
    ("log", "line"),
    [
        (POCL_3_0, "error: unknown target CPU 'generic'"),
        ("clCreateContext failed: OUT_OF_HOST_MEMORY", "clCreateContext failed: OUT_OF_HOST_MEMORY"),
        ("a\nb\n\n", "b"),
        ("", "the driver gives no reason"),
    ],
)
def test_summary(log, line):
    assert probe.summary(log) == line
