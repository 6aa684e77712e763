"""The command line ``svgf-cl``: one file a command; every error on purpose ends here, as one line and exit code 2."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from typing import NoReturn

import typer

from svgf_cl.cli import bench, compare, demo, denoise, devices, render
from svgf_cl.errors import SvgfError

# Plain help and errors: they read the same in a terminal, in a log and through grep.
app = typer.Typer(
    help="A denoiser for path-traced animation (SVGF) on any OpenCL device.",
    epilog="Exit codes: 0 fine; 1 a comparison failed or a run broke off; 2 wrong input.",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
)
for command in (devices.devices, demo.demo, render.render, denoise.denoise, compare.compare, bench.bench):
    app.command()(command)


def main(argv: Sequence[str] | None = None) -> NoReturn:
    """Run the command line on `argv` (by default the process's own arguments) and leave with its exit code."""
    try:
        app(argv, prog_name="svgf-cl")
    except SvgfError as error:
        print(f"svgf-cl: {error}", file=sys.stderr)
    sys.exit(2)
