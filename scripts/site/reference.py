"""The pages of the site that are made from the code: Python API, command line."""

from __future__ import annotations

import inspect
import re
from collections.abc import Iterator
from typing import Any

import typer

import svgf_cl
from svgf_cl.cli import application
from svgf_cl.filters.filter import Filter

Command = Any  # a command of click, or of the copy of click inside newer versions of typer

# All names that `import svgf_cl` offers, by their purpose.
TOPICS = {
    "Denoising": ("Denoiser", "TiledDenoiser", "denoiser_for", "look_ahead"),
    "Frames": ("Frame", "Inputs", "open_sequence"),
    "Motion and cameras": ("Camera", "motion_from_cameras", "motion_to_next"),
    "Checks": ("check_frame", "check_sequence"),
    "Filters": ("Kalman", "Settings", "Eaw", "Sbf", "Lbf", "Accumulation"),
    "Devices": ("Tuning",),
    "Errors": (
        "SvgfError",
        "FrameError",
        "ArgumentError",
        "SettingsError",
        "DeviceError",
        "FileError",
        "SchedulerError",
    ),
}


def api() -> str:
    """The page about the names of `import svgf_cl`, from their docstrings; reStructuredText."""
    topics = (f"{underlined(topic, '-')}\n{''.join(map(documented, names))}" for topic, names in TOPICS.items())
    return f"{underlined('Python API', '=')}\nWhat ``import svgf_cl`` offers.\n\n{''.join(topics)}"


def underlined(title: str, mark: str) -> str:
    """A heading."""
    return f"{title}\n{mark * len(title)}\n"


def documented(name: str) -> str:
    """The directive for the docstring of a name, and for those of a class's methods if users call them."""
    thing = getattr(svgf_cl, name)
    kind = "class" if inspect.isclass(thing) else "function"
    has_methods = kind == "class" and not issubclass(thing, (Filter, Exception))
    return f"\n.. auto{kind}:: svgf_cl.{name}\n" + ("   :members:\n" if has_methods else "") + "\n"


def command_line() -> str:
    """The page about the commands of ``svgf-cl``, from their declarations; Markdown."""
    group = typer.main.get_group(application())
    top = typer.Context(group, info_name="svgf-cl")
    introduction = f"# Command line\n\n{group.help}\n\n{group.epilog}\n"
    return introduction + "".join(command(each, top) for each in group.commands.values())


def command(each: Command, top: typer.Context) -> str:
    """One command: its usage, its purpose, and a row for each argument and option."""
    context = typer.Context(each, info_name=each.name, parent=top)
    usage = " ".join(each.get_usage(context).removeprefix("Usage: ").split())
    rows = [f"| `{names}` | {cell(meaning)} |" for names, meaning in options(each, context)]
    table = ["", "| option | meaning |", "|---|---|", *rows] if rows else []
    return "\n".join([f"\n## {each.name}\n```text\n{usage}\n```\n", prose(each.help or ""), *table]) + "\n"


def options(each: Command, context: typer.Context) -> Iterator[tuple[str, str]]:
    """The names and the meaning of each argument and option, as `--help` lists them."""
    for parameter in each.params:
        if record := parameter.get_help_record(context):
            yield record


def cell(text: str) -> str:
    """`text` for a cell of a table."""
    return " ".join(text.split()).replace("|", "\\|").replace("<", "\\<").replace("*", "\\*")


def prose(text: str) -> str:
    """Convert a help text to Markdown: paragraphs after a backspace, which are kept line by line, become code."""
    paragraphs = re.split(r"\n\s*\n", inspect.cleandoc(text))
    return "\n\n".join(
        f"```text\n{paragraph.removeprefix(chr(8)).strip(chr(10))}\n```" if paragraph.startswith("\b") else paragraph
        for paragraph in paragraphs
    )
