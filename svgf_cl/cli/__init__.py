"""The command line ``svgf-cl``, with one module for each command. The user's errors end here, with exit code 2."""

from __future__ import annotations

import io
import sys
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from importlib.metadata import EntryPoint, entry_points
from typing import Annotated, Any, NoReturn

import typer

from svgf_cl import __version__
from svgf_cl.cli import bench, check, compare, denoise, devices, export, formats, tune, view
from svgf_cl.cli.signals import terminated_like_interrupted
from svgf_cl.errors import SvgfError, one_line, shown

Command = Callable[..., None]

COMMANDS: dict[str, Command] = {
    "devices": devices.devices,
    "formats": formats.formats,
    "check": check.check,
    "denoise": denoise.denoise,
    "compare": compare.compare,
    "view": view.view,
    "export": export.export,
    "bench": bench.bench,
    "tune": tune.tune,
}
# Other installed packages may declare more commands: one function for each, under the command's name.
GROUP = "svgf_cl.commands"
# The order of commands in the help; any others come after these.
ORDER = (
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
)
INTERRUPTED = 130  # a shell's exit code for a program that Ctrl-C ended; here also for SIGTERM
# Settings of a command that accepts any arguments.
ANYTHING = {"ignore_unknown_options": True, "allow_extra_args": True}


@dataclass(frozen=True)
class Unavailable:
    """A declared command that cannot be imported, and the reason."""

    complaint: str

    def refuse(self) -> None:
        """Raise `SvgfError`."""
        raise SvgfError(self.complaint)


def commands() -> dict[str, Command | Unavailable]:
    """Return every command by its name: svgf_cl's own, and those of other installed packages."""
    found = {entry.name: loaded(entry) for entry in entry_points(group=GROUP)} | COMMANDS
    return {name: found[name] for name in sorted(found, key=lambda name: ((*ORDER, name).index(name), name))}


def loaded(entry: EntryPoint) -> Command | Unavailable:
    """Return the function of an entry point. If it cannot be imported, the other commands still work."""
    try:
        command: Command = entry.load()
    except Exception as error:  # other people's code may raise anything
        return Unavailable(f"{entry.name}: {entry.value} cannot be imported ({one_line(error)})")
    return command


def application() -> typer.Typer:
    """Return the command line with all installed commands."""
    # Help and errors are plain text: they look the same in a terminal, in a log and after grep.
    app = typer.Typer(
        invoke_without_command=True,
        epilog="Exit codes: 0 success; 1 a check or a run failed; 2 wrong input; 130 interrupted.",
        add_completion=False,
        rich_markup_mode=None,
        pretty_exceptions_enable=False,
        callback=common,
    )
    for name, command in commands().items():
        if isinstance(command, Unavailable):
            app.command(name, help=command.complaint, context_settings=ANYTHING)(command.refuse)
        else:
            app.command(name)(command)
    return app


def common(
    version: Annotated[bool, typer.Option("--version", help="Show the version and exit.", is_eager=True)] = False,
) -> None:
    """A denoiser for path-traced animation (Kalman, SVGF, EAW, SBF, LBF) on any OpenCL device."""
    if version:
        print(f"svgf-cl {__version__}")
        raise typer.Exit


# The base class of typer's errors for wrong options and arguments, for which typer has no name.
UsageError: type[Any] = typer.BadParameter.__mro__[1]


def main(argv: Sequence[str] | None = None) -> NoReturn:
    """Run the command line on `argv` (by default the process's own arguments) and exit with its exit code."""
    arguments = list(sys.argv[1:] if argv is None else argv) or ["--help"]
    leave(application(), arguments, "svgf-cl", "svgf-cl")


def leave(app: typer.Typer, arguments: Sequence[str], name: str, usage: str) -> NoReturn:
    """Run `app` and exit with its exit code.

    Errors are printed in one line that begins with `name`. `usage` is the command as the user calls it.
    """
    for stream in (sys.stdout, sys.stderr):
        # A file's name may not be valid text: then it is printed with Python's escapes.
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")
    try:
        with plain_warnings(name), terminated_like_interrupted():
            code = app(list(arguments), prog_name=usage, standalone_mode=False)
        if code == INTERRUPTED:
            raise KeyboardInterrupt
        sys.exit(code)
    except SvgfError as error:
        complaint = str(error)
    except UsageError as error:
        complaint = " ".join(f"{usage_complaint(error)}; try '{called(error, app, arguments, usage)} --help'".split())
    except MemoryError as error:
        complaint = f"not enough memory: {error}"
    except OSError as error:  # for a path that no command has checked
        complaint = f"{error.filename or 'output'}: {error.strerror or error}"
    except (KeyboardInterrupt, typer.Abort):  # typer's version decides which of these, or the exit code
        print(f"{name}: interrupted", file=sys.stderr)
        sys.exit(INTERRUPTED)
    print(f"{name}: {printable(complaint)}", file=sys.stderr)
    sys.exit(2)


def usage_complaint(error: Any) -> str:
    """Return what is wrong with an option or argument.

    Typer checks some values with pydantic, whose messages do not say what was found: it is added.
    """
    complaint: str = error.format_message().rstrip(".")
    details = getattr(error.__cause__, "errors", None)
    return f"{complaint}, got {shown(details()[0]['input'])}" if callable(details) else complaint


def called(error: Any, app: typer.Typer, arguments: Sequence[str], usage: str) -> str:
    """Return the command that was called wrongly; for some errors typer does not know it."""
    if error.ctx:
        return str(error.ctx.command_path)
    known = getattr(typer.main.get_command(app), "commands", ())
    return f"{usage} {arguments[0]}" if arguments and arguments[0] in known else usage


@contextmanager
def plain_warnings(name: str) -> Iterator[None]:
    """Print each warning for the user once, in one line on stderr, without the source line that Python would add."""
    told: set[str] = set()  # each chunk of a shot may give the same warning
    with warnings.catch_warnings():
        usual = warnings.showwarning

        def show(message: Warning | str, category: type[Warning], *where: Any, **rest: Any) -> None:
            if category is UserWarning:
                text = printable(one_line(message))
                if text not in told:
                    print(f"{name}: warning: {text}", file=sys.stderr)
                told.add(text)
            else:
                usual(message, category, *where, **rest)

        warnings.showwarning = show
        yield


def printable(text: str) -> str:
    """Escape characters that are invisible or control the terminal: names of files and folders may contain any."""
    return "".join(char if char.isprintable() or char == "\n" else ascii(char)[1:-1] for char in text)
