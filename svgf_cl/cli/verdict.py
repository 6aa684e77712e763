"""Ends a command that checks something: prints a line for each failed check, and exits with code 1 if there is one."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import typer

from svgf_cl.gate import Check, write_junit


def leave_with(checks: Sequence[Check], command: str, junit: Path | None) -> None:
    """Write the JUnit file, if any, print failed checks on stderr, and exit with code 1 if there are any, else 0."""
    if junit:
        write_junit(junit, command, checks)
    failed = [check for check in checks if check.complaint]
    for check in failed:
        typer.echo(f"{check.group}, {check.name}: {check.complaint}", err=True)
    raise typer.Exit(1 if failed else 0)
