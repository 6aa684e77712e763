"""Processes with the same code agree on its version; any other source or library makes another one."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from svgf_cl import fingerprint
from svgf_cl.fingerprint import code_version, library_version


def test_other_processes_agree() -> None:
    program = "from svgf_cl.fingerprint import library_version; print(library_version())"
    environment = os.environ | {"PYTHONHASHSEED": "12345"}
    said = subprocess.run([sys.executable, "-c", program], env=environment, capture_output=True, text=True, check=True)
    assert said.stdout.strip() == library_version()


def test_texts_do_not_run_into_each_other() -> None:
    sources = [[("ab", "c")], [("a", "bc")], [("a", "b"), ("c", "")], [("a", "b")], [], [("a", "b")] * 2]
    assert len({code_version(each, []) for each in sources}) == len(sources)


def test_another_library_is_another_version(monkeypatch: pytest.MonkeyPatch) -> None:
    before = code_version([], ["numpy"])
    monkeypatch.setattr(fingerprint, "version", lambda name: "0.0")
    assert code_version([], ["numpy"]) != before


def test_another_source_or_kernel_is_another_version(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("fingerprint.py", "kernel.cl", "notes.txt"):
        (tmp_path / name).touch()
    monkeypatch.setattr(fingerprint, "__file__", str(tmp_path / "fingerprint.py"))
    monkeypatch.setattr(fingerprint, "files", lambda package: tmp_path)
    seen = [library_version.__wrapped__()]
    for name in ("fingerprint.py", "kernel.cl"):
        (tmp_path / name).write_text("changed")
        seen.append(library_version.__wrapped__())
    assert len(set(seen)) == 3
    (tmp_path / "notes.txt").write_text("changed")
    assert library_version.__wrapped__() == seen[-1]
