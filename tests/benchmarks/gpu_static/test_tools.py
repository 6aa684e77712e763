"""What is missing is named, with what installs it."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from benchmarks.gpu_static import tools
from svgf_cl import SvgfError


def test_everything_missing_is_named_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", "")
    monkeypatch.setattr(tools, "from_wheel", lambda distribution, name: None)
    monkeypatch.setattr(tools, "under", lambda patterns, name: None)
    with pytest.raises(SvgfError) as caught:
        tools.find()
    lines = str(caught.value).splitlines()
    assert len(lines) == 2 + len(tools.WANTED)
    for package in ("clang-19", "clang-15", "llvm-spirv-15", "spirv-tools", "rocm-device-libs", "libclc-15"):
        assert any(line.endswith(f"apt-get install {package}") for line in lines)
    assert sum("pip install 'svgf-cl[gpu-static]'" in line for line in lines) == 2


def test_as_a_program_it_ends_with_exit_code_1(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", "")
    with pytest.raises(SystemExit) as caught:
        tools.main()
    assert "clang 19 or later: apt-get install clang-19" in str(caught.value)


def test_one_missing_is_named_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    found = {name: tools.Wanted(lambda: Path(sys.executable), "it", "it") for name in tools.WANTED}
    monkeypatch.setattr(tools, "WANTED", {**found, "ptxas": tools.Wanted(lambda: None, "ptxas", tools.EXTRA)})
    with pytest.raises(SvgfError) as caught:
        tools.find()
    assert len(str(caught.value).splitlines()) == 3


def test_the_version_that_is_asked_for_comes_before_later_ones(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    for name in ("clang-20", "clang-21", "clang-18"):
        (tmp_path / name).write_text("")
        (tmp_path / name).chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path))
    assert tools.WANTED["clang"].find() == tmp_path / "clang-20"


def test_llvm_spirv_is_of_the_version_of_its_clang(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    for name in ("clang-15", "clang-17", "llvm-spirv-16", "llvm-spirv-17"):
        (tmp_path / name).write_text("")
        (tmp_path / name).chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path))
    assert tools.spirv_pair("clang") == tmp_path / "clang-17"
    assert tools.spirv_pair("llvm-spirv") == tmp_path / "llvm-spirv-17"


def test_a_program_of_a_package_that_is_not_installed() -> None:
    assert tools.from_wheel("no-such-package-of-svgf-cl", "ptxas") is None


@pytest.mark.parametrize(
    ("said", "expected"),
    [
        ("Debian clang version 19.1.7 (3~deb12u1)", "19.1.7"),
        ("Debian LLVM version 15.0.6", "15.0.6"),
        ("SPIRV-Tools v2023.1 unknown hash, 2023-02-15T14:03:51", "2023.1"),
        ("Copyright (c) 2005-2025\nCuda compilation tools, release 12.9, V12.9.86", "12.9.86"),
        ("", "unknown"),
    ],
)
def test_the_version_of_a_tool(said: str, expected: str, tmp_path: Path) -> None:
    tool = tmp_path / "tool"
    tool.write_text(f"#!/bin/sh\ncat <<'END'\n{said}\nEND\n")
    tool.chmod(0o755)
    assert tools.version(tool) == expected
