"""How a command that checks something ends: with a line for each check that failed, and exit code 1 if any did."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import typer

from svgf_cl.gate import Check, write_junit


def leave_with(checks: Sequence[Check], command: str, junit: Path | None) -> None:
    """Write the JUnit file, if any, and leave with exit code 1 where a check failed, a line for each on stderr."""
    if junit:
        write_junit(junit, command, checks)
    failed = [check for check in checks if check.complaint]
    for check in failed:
        typer.echo(f"{check.group}, {check.name}: {check.complaint}", err=True)
    raise typer.Exit(1 if failed else 0)
