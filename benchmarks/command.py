"""Runs the command line of a benchmark; errors end in one line, as those of ``svgf-cl`` do."""

from __future__ import annotations

import sys
from collections.abc import Callable

import typer

from svgf_cl.cli import leave


def run(command: Callable[..., None], module: str) -> None:
    """Run `command`, of this module, with the process's arguments; a user's error ends in exit code 2."""
    app = typer.Typer(add_completion=False, rich_markup_mode=None, pretty_exceptions_enable=False)
    app.command()(command)
    leave(app, sys.argv[1:], module.rpartition(".")[2], f"python -m {module}")
