"""The command line ``svgf-cl``: one file a command; all that a user can get wrong ends here, in exit code 2."""

from __future__ import annotations

import io
import sys
from collections.abc import Sequence
from typing import Annotated, Any, NoReturn

import typer

from svgf_cl import __version__
from svgf_cl.cli import bench, check, compare, demo, denoise, devices, gallery, render, tune
from svgf_cl.errors import SvgfError

# Plain help and errors: they read the same in a terminal, in a log and through grep.
app = typer.Typer(
    invoke_without_command=True,
    epilog="Exit codes: 0 fine; 1 a comparison or check failed, or a run broke off; 2 wrong input.",
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
)
for command in (
    devices.devices,
    demo.demo,
    gallery.scenes,
    render.render,
    check.check,
    denoise.denoise,
    compare.compare,
    tune.tune,
):
    app.command()(command)
app.add_typer(bench.app, name="bench")


@app.callback()
def common(
    version: Annotated[bool, typer.Option("--version", help="Show the version and exit.", is_eager=True)] = False,
) -> None:
    """A denoiser for path-traced animation (SVGF) on any OpenCL device."""
    if version:
        print(f"svgf-cl {__version__}")
        raise typer.Exit


# typer has no name of its own for it: every option and argument it cannot make sense of.
UsageError: type[Any] = typer.BadParameter.__mro__[1]


def main(argv: Sequence[str] | None = None) -> NoReturn:
    """Run the command line on `argv` (by default the process's own arguments) and leave with its exit code."""
    for stream in (sys.stdout, sys.stderr):
        # A file may be called what is no text at all: it is shown as Python would write it.
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")
    arguments = list(sys.argv[1:] if argv is None else argv) or ["--help"]
    try:
        sys.exit(app(arguments, prog_name="svgf-cl", standalone_mode=False))
    except SvgfError as error:
        complaint = str(error)
    except UsageError as error:
        command = error.ctx.command_path if error.ctx else "svgf-cl"
        complaint = " ".join(f"{error.format_message().rstrip('.')}; try '{command} --help'".split())
    except MemoryError as error:
        complaint = f"not enough memory: {error}"
    except OSError as error:  # a path that no command has looked at: the system says what is wrong with it
        complaint = f"{error.filename or 'output'}: {error.strerror or error}"
    except (KeyboardInterrupt, typer.Abort):  # which of them, or neither, depends on typer's version
        sys.exit(130)
    print(f"svgf-cl: {printable(complaint)}", file=sys.stderr)
    sys.exit(2)


def printable(text: str) -> str:
    """Escape what would not show, or do something else than show: names come from files and folders of anyone."""
    return "".join(char if char.isprintable() or char == "\n" else ascii(char)[1:-1] for char in text)
