"""Whatever an option is given, wrong input ends in one line that says so, never in a traceback."""

from __future__ import annotations

import io
from contextlib import redirect_stderr, redirect_stdout

import pytest
import typer
from hypothesis import given
from hypothesis import strategies as st

from svgf_cl.cli import application, main
from svgf_cl.cli.options import MAX_FRAMES
from tests.fuzz.effort import effort

COMMANDS = typer.main.get_command(application()).commands  # type: ignore[attr-defined]
# Every option of every command that takes a value.
OPTIONS = [
    (name, parameter.opts[0])
    for name, command in COMMANDS.items()
    for parameter in command.params
    if parameter.opts[0].startswith("-") and not parameter.is_flag
]
NUMBERS = ("", "nan", "-inf", "1e999", "-1", "0", "1.5", "0x10", "1_000", "\uff11", "9" * 30, "9" * 5000, "1,2", "1/2")
values = (
    st.sampled_from(NUMBERS)
    | st.text()
    | st.builds("{}x{}".format, st.sampled_from(NUMBERS), st.sampled_from(NUMBERS))
    | st.builds("{}={}".format, st.sampled_from(("taps", "iterations", "alpha_taa", "blur")), st.sampled_from(NUMBERS))
)


def refusal(*argv: str) -> str:
    """What a command line that is refused says."""
    said = io.StringIO()
    with redirect_stdout(io.StringIO()), redirect_stderr(said), pytest.raises(SystemExit) as left:
        main(argv)
    assert left.value.code == 2
    return said.getvalue()


@effort()
@given(option=st.sampled_from(OPTIONS), value=values)
def test_any_value_of_an_option(option: tuple[str, str], value: str) -> None:
    """With a size or a file that is wrong for certain, so that nothing runs where the value is right."""
    command, name = option
    parameters = COMMANDS[command].params
    required = [parameter.opts[0] for parameter in parameters if parameter.required]
    files = [f"{opt}=nowhere" if opt.startswith("-") else "nowhere/nothing.exr" for opt in required]
    sizes = ["--size=0x0" for parameter in parameters if "--size" in parameter.opts]
    said = refusal(command, *files, f"{name}={value}", *sizes)
    assert said.startswith("svgf-cl: ")
    assert said.count("\n") == 1


@pytest.mark.parametrize("size", ["9" * 5000 + "x1", "1x" + "9" * 7, "1\u0663x1", "32769x1"])
def test_a_size_beyond_all_bounds(size: str) -> None:
    assert len(refusal("tune", "--size", size)) < 200


@pytest.mark.parametrize("command", [["demo"], ["render", "cornell", "-o", "nowhere"]])
def test_frames_without_end(command: list[str]) -> None:
    assert "'--frames'" in refusal(*command, "--frames", str(MAX_FRAMES + 1))
