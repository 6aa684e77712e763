"""Every command in the pages is one that exists, with options that it has and arguments that it takes."""

from __future__ import annotations

import re
import runpy
import shlex
import shutil
import sys
from collections.abc import Callable, Sequence
from functools import cache
from importlib.metadata import metadata
from pathlib import Path
from typing import Any

import pytest
import typer

from benchmarks import command as benchmark_command
from svgf_cl.cli import UsageError, application
from svgf_cl.io.frames import write_frame
from svgf_cl.io.synthetic import room_frames
from tests.command_line import run
from tests.pages import PAGES, ROOT, blocks, name_of

# Programs that others made: they are installed here, and what they are given is not looked at.
FOREIGN = ("dask", "openjd", "pytest-benchmark")
# Programs that this machine may lack: nothing is looked at.
ABSENT = ("docker",)
CHEAP = ("devices", "formats", "check", "denoise")  # those that a test can afford to run


@cache
def commands() -> dict[str, Any]:
    """Those of ``svgf-cl``."""
    return dict(typer.main.get_group(application()).commands)


@cache
def benchmark(module: str) -> Any:
    """The command that ``python -m module`` is; it is not run."""
    found: list[Callable[..., None]] = []
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(benchmark_command, "run", lambda command, _: found.append(command))
        patch.setattr(sys, "argv", [module])
        runpy.run_module(module, run_name="__main__")
    app = typer.Typer()
    app.command()(found[0])
    return typer.main.get_command(app)


def parse(command: Any, arguments: Sequence[str]) -> None:
    """Fail where a command would not take these arguments."""
    try:
        command.make_context("command", list(arguments))
    except UsageError as error:
        pytest.fail(error.format_message())


def check_own(arguments: Sequence[str]) -> None:
    name, *rest = arguments
    parse(commands()[name], rest)


def check_make(arguments: Sequence[str]) -> None:
    targets = re.findall(r"^([a-z-]+):", (ROOT / "Makefile").read_text(), re.MULTILINE)
    assert set(arguments) <= set(targets)


def check_python(arguments: Sequence[str]) -> None:
    if arguments[0] != "-m":
        assert (ROOT / arguments[0]).is_file()
    elif arguments[1] in ("pytest", "benchmarks.accuracy_page"):  # they take files
        assert all((ROOT / path).exists() for path in arguments[2:])
    else:
        parse(benchmark(arguments[1]), arguments[2:])


def check_pip(arguments: Sequence[str]) -> None:
    extras = re.findall(r"(?:\.|svgf-cl)\[([\w,-]+)\]", " ".join(arguments))
    assert {name for each in extras for name in each.split(",")} <= set(metadata("svgf_cl").get_all("Provides-Extra"))


CHECKS = {"svgf-cl": check_own, "make": check_make, "python": check_python, "pip": check_pip}


def words_of(line: str) -> list[str]:
    """A command's words, the first of its alternatives in braces, without what is set in front of it."""
    words = shlex.split(re.sub(r"\{([^},]*)[^}]*\}", r"\1", line), comments=True)
    while words and re.match(r"\w+=", words[0]):
        words.pop(0)
    return words


def check(line: str) -> None:
    """Fail where a line is not a command that works."""
    words = words_of(line)
    program = Path(words[0]).name if words else ""
    if program in FOREIGN:
        assert shutil.which(program, path=str(Path(sys.executable).parent)), program
    elif words and program not in ABSENT:
        assert program in CHECKS, f"{program}: add how tests check it, or that it is FOREIGN or ABSENT"
        CHECKS[program](words[1:])


def command_lines(page: Path) -> list[str]:
    """The lines of the page's blocks of shell, those that go on joined."""
    return [line for block in blocks(page.read_text(), "sh") for line in block.replace("\\\n", " ").splitlines()]


@pytest.mark.parametrize("page", [page for page in PAGES if command_lines(page)], ids=name_of)
def test_commands_in_blocks_are_taken(page: Path) -> None:
    for line in command_lines(page):
        check(line)


MENTIONED = re.compile(r"`((?:PYOPENCL_CTX=\S+ )?(?:\.venv/bin/)?(?:svgf-cl|make|python|pip) [^`\n]*)`")


@pytest.mark.parametrize("page", [page for page in PAGES if MENTIONED.search(page.read_text())], ids=name_of)
def test_commands_in_sentences_exist_with_their_options(page: Path) -> None:
    """What follows may be cut short, or a word in its place, so only names are checked."""
    for line in MENTIONED.findall(re.sub(r"^```.*?^```", "", page.read_text(), flags=re.DOTALL | re.MULTILINE)):
        program, *rest = words_of(line)
        if program == "svgf-cl" and not rest[0].startswith("-"):
            command = commands()[rest[0]]
        elif rest[:1] == ["-m"] and rest[1].startswith("benchmarks") and rest[1] != "benchmarks.accuracy_page":
            command = benchmark(rest[1])
        else:
            continue
        known = {name for option in command.params for name in (*option.opts, *option.secondary_opts)}
        assert {word.partition("=")[0] for word in rest if re.match(r"--?[a-z]", word)} - {"-m"} <= known, line


def test_the_commands_of_the_start_page_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """On frames such as `svgf-cl render` writes; it has tests of its own, and takes long to compile."""
    monkeypatch.chdir(tmp_path)
    for number, frame in enumerate(room_frames((90, 160), 3)):
        write_frame(tmp_path / "out" / "box" / f"frame.{number:04d}.exr", frame)
    lines = [words_of(line)[1:] for line in command_lines(ROOT / "README.md") if line.startswith("svgf-cl ")]
    ran = [words for words in lines if words[0] in CHEAP]
    assert {words[0] for words in ran} >= {"devices", "check", "denoise"}
    for words in ran:
        assert run(*words) == 0, words
    assert list((tmp_path / "out" / "clean").glob("*.exr"))


@pytest.mark.parametrize(
    "line",
    [
        "svgf-cl denoise shot -o out --no-such-option",
        "svgf-cl denoise",
        "svgf-cl absent",
        "make absent",
        "python absent.py",
        "python -m benchmarks.joins --absent",
        "pip install '.[absent]'",
        "rm -rf out",
    ],
)
def test_a_wrong_command_is_found(line: str) -> None:
    with pytest.raises((AssertionError, KeyError, pytest.fail.Exception)):
        check(line)
