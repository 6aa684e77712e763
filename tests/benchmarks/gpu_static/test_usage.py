"""Options that clang gets, and what a tool that fails says."""

from __future__ import annotations

import sys

import pytest

from benchmarks.builds import Build
from benchmarks.gpu_static.usage import Instructions, RejectedError, language, passed, said_by
from svgf_cl.device.programs import OPTIONS


def test_clang_gets_the_options_of_drivers_but_warns() -> None:
    given = language(Build("atrous", (*OPTIONS, "-DVW=1"), "any"))
    assert {*OPTIONS, "-DVW=1"} - set(given) == {"-w"}


def test_an_option_for_the_compiler_proper_is_passed_with_each_value() -> None:
    assert " ".join(passed("-link", "a.bc", "b.bc")) == "-Xclang -link -Xclang a.bc -Xclang -link -Xclang b.bc"


def test_instructions_are_counted_by_kind() -> None:
    found = Instructions.counted(iter(("ld_a", "ld_b", "st", "add", "fadd", "end")), "ld_", "st", "add")
    assert found == Instructions(total=6, loads=2, stores=1, integer=1)


def test_what_a_failing_tool_says_is_the_reason() -> None:
    with pytest.raises(RejectedError, match="no such kernel"):
        said_by([sys.executable, "-c", "import sys; sys.exit('no such kernel')"])
    assert said_by([sys.executable, "-c", "print('fine')"]) == "fine\n"
