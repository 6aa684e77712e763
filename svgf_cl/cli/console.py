"""What all commands show alike: progress, tables, milliseconds."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from itertools import count
from statistics import median
from typing import TypeVar

from rich.console import Console
from rich.progress import Progress, TextColumn
from rich.table import Table

from svgf_cl.cli.log import Log

Item = TypeVar("Item")

SLOWEST_STEP = 600.0  # seconds between two steps from which the time left can still be told

WIDE = 160  # columns where the output is no terminal: nothing is gained by breaking words in a file
NARROW = 72  # columns where a terminal has fewer: it breaks lines itself, where a table would leave out numbers


@contextmanager
def progress_bar(title: str, total: int) -> Iterator[Callable[[], None]]:
    """Show progress and the time left, on stderr: a bar on a terminal, else lines; call what this yields per step."""
    console = Console(stderr=True)
    if not console.is_terminal:
        log, steps = Log(title, total), count(1)
        yield lambda: log.report(next(steps))
        return
    with Progress(console=console, disable=not total) as progress:
        task = progress.add_task(title, total=total)
        yield lambda: progress.advance(task)


@contextmanager
def share_bar(title: str, total: int) -> Iterator[Callable[[float, str], None]]:
    """Show progress as `progress_bar` does; call what this yields with how much of `total` is done, and a remark.

    What is done at the first call was done before: the time left is judged by what follows.
    """
    console = Console(stderr=True)
    if not console.is_terminal:
        yield Log(title, total, resumed=True).report
        return
    columns = (*Progress.get_default_columns(), TextColumn("{task.fields[remark]}"))
    with Progress(*columns, console=console, speed_estimate_period=SLOWEST_STEP) as progress:
        progress.add_task(title, total=None, remark="")
        (task,) = progress.tasks

        def report(done: float, remark: str) -> None:
            if task.total is None:
                task.total, task.completed = total, done
            progress.update(task.id, completed=done, remark=remark)

        yield report


def tracked(items: Iterable[Item], total: int, title: str) -> Iterator[Item]:
    """Pass `items` on under a progress bar."""
    with progress_bar(title, total) as advance:
        for item in items:
            yield item
            advance()


def show(title: str, columns: Sequence[str], rows: Iterable[Sequence[str]], words: int = 1) -> None:
    """Print a table under its title; the first `words` columns are words, the others are numbers."""
    print(title)  # not the table's own, which would be wrapped to its width
    table = Table()
    for index, column in enumerate(columns):
        table.add_column(column, justify="left" if index < words else "right")
    for row in rows:
        table.add_row(*row)
    screen().print(table)


def screen() -> Console:
    """What tables are printed on; nowhere, where the standard output is closed."""
    terminal = sys.stdout is not None and sys.stdout.isatty()
    return Console(width=max(NARROW, Console().width) if terminal else WIDE)


def kept_of(count: int) -> str:
    """Say how many files were kept of an earlier run, if any."""
    return f", {count} of them kept from an earlier run" if count else ""


def show_times(profiles: Sequence[Mapping[str, float]]) -> None:
    """Print the median time of each pass over frames, each a mapping from pass to milliseconds."""
    times = {name: median(profile.get(name, 0.0) for profile in profiles) for name in profiles[-1]}
    rows = [(name, f"{time:.2f}") for name, time in (times | {"total": sum(times.values())}).items()]
    show(f"time on the device, median of {len(profiles)} frames", ("pass", "ms"), rows)
