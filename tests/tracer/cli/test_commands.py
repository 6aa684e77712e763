"""The tracer's commands are part of ``svgf-cl`` wherever it is installed, and start without what it is made of."""

from __future__ import annotations

import subprocess
import sys

import pytest

from svgf_cl.cli import ORDER
from tests.command_line import run

COMMANDS = ("demo", "scenes", "render")

LOOK = """
import sys
from svgf_cl_tracer.cli import demo, gallery, render
print([name for name in ("numba", "embreex", "trimesh", "scipy", "pydantic") if name in sys.modules])
"""


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_has_help_with_an_example(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(command, "--help") == 0
    said = capsys.readouterr().out
    assert f"svgf-cl {command}" in said.split("Examples:")[1]


def test_help_names_every_command_in_order(capsys: pytest.CaptureFixture[str]) -> None:
    assert run("--help") == 0
    said = capsys.readouterr().out
    places = [said.index(f"\n  {command} ") for command in ORDER]
    assert places == sorted(places)


def test_help_takes_nothing_that_the_tracer_needs() -> None:
    looked = subprocess.run([sys.executable, "-c", LOOK], capture_output=True, text=True, check=True)
    assert looked.stdout == "[]\n"
