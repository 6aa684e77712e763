"""Runs a benchmark's command line: what goes wrong ends in one line, as that of ``svgf-cl`` does."""

from __future__ import annotations

import sys
from collections.abc import Callable

import typer

from svgf_cl.errors import SvgfError


def run(command: Callable[..., None], name: str) -> None:
    """Run `command` on the process's arguments; an `SvgfError` is told under `name`, and ends in exit code 2."""
    try:
        typer.run(command)
    except SvgfError as error:
        print(f"{name}: {error}", file=sys.stderr)
        sys.exit(2)
