"""The pages of the site that are made from the code: Python API, settings, command line."""

from __future__ import annotations

import inspect
import re
from collections.abc import Iterator
from dataclasses import fields
from typing import Any

import typer

import svgf_cl
from svgf_cl.cli import application
from svgf_cl.filters import DEFAULT, FILTERS
from svgf_cl.filters.filter import Filter
from svgf_cl.settings import DOMAIN, REASON, UNIT

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


def settings() -> str:
    """The page about all filters' settings, from their declarations; Markdown."""
    introduction = (
        "# Settings\n\n"
        "Every filter is a class of settings, such as `Kalman(iterations=3)`, for `Denoiser(..., settings=...)`; "
        "on the command line: `svgf-cl denoise --filter kalman --set iterations=3`.\n"
        f"`{DEFAULT.__name__}` is the default.\n"
        "What the settings mean in the equations: [algorithm.md](algorithm.md).\n"
    )
    return introduction + "".join(settings_of(each) for each in FILTERS.values())


def settings_of(kind: type[Filter]) -> str:
    """The settings of one filter: default, values and unit of each, its meaning, and the reason for the default."""
    summary = (kind.__doc__ or "").partition("\n")[0]
    items = []
    for each in fields(kind):
        values = ", ".join(part for part in (str(each.metadata[DOMAIN]), each.metadata[UNIT]) if part)
        items.append(f"- **`{each.name}`** `= {each.default!r}`, {values}.\\\n  {each.metadata[REASON]}\n")
    return f"\n## {kind.__name__}\n{summary} `--filter {kind.name}`\n\n{''.join(items)}"


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
