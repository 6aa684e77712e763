"""The command line as people use it: help, usage, and one clear line for whatever goes wrong."""

from __future__ import annotations

from collections.abc import Callable
from importlib.metadata import EntryPoint

import pytest

from svgf_cl import __version__
from svgf_cl.cli import GROUP, commands
from svgf_cl.cli.tune import tune
from tests.command_line import run

# svgf_cl's own; the others come with other packages.
COMMANDS = ("devices", "formats", "check", "denoise", "view", "compare", "bench", "tune")


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_has_help_with_an_example(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(command, "--help") == 0
    said = capsys.readouterr().out
    assert f"svgf-cl {command}" in said.split("Examples:")[1]


def test_help_names_every_command(capsys: pytest.CaptureFixture[str]) -> None:
    assert run("--help") == 0
    said = capsys.readouterr().out
    assert all(f"\n  {command} " in said for command in COMMANDS)
    assert "..." not in said.split("Commands:")[1], "the first sentence of a command's docstring is too long for a line"


@pytest.mark.parametrize(
    ("words", "argv"),
    [
        ("'juggle'; try 'svgf-cl --help'", ["juggle"]),
        ("'FRAMES'; try 'svgf-cl check --help'", ["check"]),
        ("'-o'", ["denoise", "frames"]),
        ("--bogus; try 'svgf-cl compare --help'", ["compare", "--bogus"]),
        ("'--png' does not take a value; try 'svgf-cl denoise --help'", ["denoise", "a", "-o", "b", "--png=3"]),
    ],
)
def test_wrong_usage_is_one_line(words: str, argv: list[str], refused) -> None:
    refused(words, *argv)


def test_a_number_out_of_range_is_named(capsys: pytest.CaptureFixture[str]) -> None:
    assert run("compare", "--frames", "-7") == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "'--frames'" in line
    assert "-7" in line
    assert line.endswith("; try 'svgf-cl compare --help'")


def test_no_command_at_all_shows_help(capsys: pytest.CaptureFixture[str]) -> None:
    assert run() == 0
    assert "Usage: svgf-cl" in capsys.readouterr().out


@pytest.mark.parametrize(("error", "code"), [(KeyboardInterrupt(), 130), (MemoryError("8 EiB"), 2)])
def test_what_comes_from_outside_leaves_no_traceback(
    error: BaseException, code: int, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def broken(*_: object, **__: object) -> None:
        raise error

    monkeypatch.setattr("svgf_cl.bench.suite.Suite.run", broken)
    assert run("bench") == code
    said = capsys.readouterr().err
    assert said.strip() == ("svgf-cl: not enough memory: 8 EiB" if code == 2 else "svgf-cl: interrupted")


def test_version(capsys: pytest.CaptureFixture[str]) -> None:
    assert run("--version") == 0
    assert capsys.readouterr().out == f"svgf-cl {__version__}\n"


# Commands of other packages


@pytest.fixture
def declare(monkeypatch: pytest.MonkeyPatch) -> Callable[..., None]:
    """As if these commands were declared, and no others: a name, and where the function is."""

    def declared(**commands: str) -> None:
        found = [EntryPoint(name, value, GROUP) for name, value in commands.items()]
        monkeypatch.setattr("svgf_cl.cli.entry_points", lambda group: [each for each in found if each.group == group])

    return declared


def juggle(balls: int = 3) -> None:
    """Throw so many balls."""
    print(f"{balls} in the air")


def test_a_declared_command_is_run_like_any_other(declare, refused, capsys: pytest.CaptureFixture[str]) -> None:
    declare(juggle=f"{__name__}:juggle")
    assert run("juggle", "--balls", "5") == 0
    assert capsys.readouterr().out == "5 in the air\n"
    refused("'--balls'", "juggle", "--balls", "five")


def test_commands_are_listed_in_one_order(declare) -> None:
    declare(zoom="a:b", juggle="a:b", render="a:b", demo="a:b", scenes="a:b", tune="a:b")
    known = [
        "devices",
        "demo",
        "scenes",
        "render",
        "formats",
        "check",
        "denoise",
        "view",
        "compare",
        "export",
        "bench",
        "tune",
    ]
    assert list(commands()) == [*known, "juggle", "zoom"]
    assert commands()["tune"] is tune, "no other package replaces a command of svgf_cl"


@pytest.mark.parametrize("value", ["no.such.module:juggle", f"{__name__}:no_such_function"])
def test_a_command_that_cannot_be_imported_breaks_no_other(
    value: str, declare, refused, capsys: pytest.CaptureFixture[str]
) -> None:
    declare(juggle=value)
    refused(f"juggle: {value} cannot be imported (", "juggle", "--balls", "5", "ball")
    assert run("--help") == 0
    assert "\n  juggle " in capsys.readouterr().out
    assert run("juggle", "--help") == 0
    assert run("compare", "--help") == 0
