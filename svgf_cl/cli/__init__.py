"""The command line ``svgf-cl``: one file a command; all that a user can get wrong ends here, in exit code 2."""

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
from svgf_cl.errors import SvgfError, one_line

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
# Installed packages may declare more: a function each, under the command's name.
GROUP = "svgf_cl.commands"
# As the help lists them; any others come behind.
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
INTERRUPTED = 130  # as a shell has it of a program that Ctrl-C ends; so does SIGTERM here
# What a command says that takes whatever comes.
ANYTHING = {"ignore_unknown_options": True, "allow_extra_args": True}


@dataclass(frozen=True)
class Unavailable:
    """A declared command that cannot be imported, and why."""

    complaint: str

    def refuse(self) -> None:
        """Raise `SvgfError`."""
        raise SvgfError(self.complaint)


def commands() -> dict[str, Command | Unavailable]:
    """Every command by its name: svgf_cl's own, and those of other packages that are installed."""
    found = {entry.name: loaded(entry) for entry in entry_points(group=GROUP)} | COMMANDS
    return {name: found[name] for name in sorted(found, key=lambda name: ((*ORDER, name).index(name), name))}


def loaded(entry: EntryPoint) -> Command | Unavailable:
    """The function of an entry point; whatever is wrong with it, the other commands work."""
    try:
        command: Command = entry.load()
    except Exception as error:  # it runs what others wrote
        return Unavailable(f"{entry.name}: {entry.value} cannot be imported ({one_line(error)})")
    return command


def application() -> typer.Typer:
    """The command line with all that is installed."""
    # Plain help and errors: they read the same in a terminal, in a log and through grep.
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


# typer has no name of its own for it: every option and argument it cannot make sense of.
UsageError: type[Any] = typer.BadParameter.__mro__[1]


def main(argv: Sequence[str] | None = None) -> NoReturn:
    """Run the command line on `argv` (by default the process's own arguments) and leave with its exit code."""
    arguments = list(sys.argv[1:] if argv is None else argv) or ["--help"]
    leave(application(), arguments, "svgf-cl", "svgf-cl")


def leave(app: typer.Typer, arguments: Sequence[str], name: str, usage: str) -> NoReturn:
    """Run `app` and leave with its exit code; errors are one line, told under `name`. `usage` is how it is called."""
    for stream in (sys.stdout, sys.stderr):
        # A file may be called what is no text at all: it is shown as Python would write it.
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
        command = error.ctx.command_path if error.ctx else usage
        complaint = " ".join(f"{error.format_message().rstrip('.')}; try '{command} --help'".split())
    except MemoryError as error:
        complaint = f"not enough memory: {error}"
    except OSError as error:  # a path that no command has looked at: the system says what is wrong with it
        complaint = f"{error.filename or 'output'}: {error.strerror or error}"
    except (KeyboardInterrupt, typer.Abort):  # which of them, or the code alone, depends on typer's version
        print(f"{name}: interrupted", file=sys.stderr)
        sys.exit(INTERRUPTED)
    print(f"{name}: {printable(complaint)}", file=sys.stderr)
    sys.exit(2)


@contextmanager
def plain_warnings(name: str) -> Iterator[None]:
    """Inside, what is meant for the user is said once, in one line on stderr; Python would add where it is from."""
    told: set[str] = set()  # each chunk of a shot may warn of the same
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
    """Escape what would not show, or do something else than show: names come from files and folders of anyone."""
    return "".join(char if char.isprintable() or char == "\n" else ascii(char)[1:-1] for char in text)
