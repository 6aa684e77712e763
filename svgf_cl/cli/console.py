"""Output that all commands share: progress, tables, and times."""

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

SLOWEST_STEP = 600.0  # most seconds between two steps from which the time left is estimated

WIDE = 160  # columns of a table in a file, where there is no need to break words
NARROW = 72  # least columns of a table: a narrower terminal breaks lines itself, while a table would lose numbers


@contextmanager
def progress_bar(title: str, total: int) -> Iterator[Callable[[], None]]:
    """Show progress and the time left on stderr: a bar in a terminal, else lines.

    It yields a function to call after each step.
    """
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
    """Show progress as `progress_bar` does, with remarks.

    It yields a function to call with how much of `total` is done, and a remark. The amount in the first call was done
    before: it does not count for the estimate of the time left.
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
    """Yield `items`, and show progress."""
    with progress_bar(title, total) as advance:
        for item in items:
            yield item
            advance()


def show(title: str, columns: Sequence[str], rows: Iterable[Sequence[str]], words: int = 1) -> None:
    """Print a table below its title; the first `words` columns are words, the others are numbers."""
    print(title)  # a title of the table itself would be wrapped to the table's width
    table = Table()
    for index, column in enumerate(columns):
        table.add_column(column, justify="left" if index < words else "right")
    for row in rows:
        table.add_row(*row)
    screen().print(table)


def screen() -> Console:
    """Return the console for tables; it prints nothing if standard output is closed."""
    terminal = sys.stdout is not None and sys.stdout.isatty()
    return Console(width=max(NARROW, Console().width) if terminal else WIDE)


def counted(count: int, thing: str) -> str:
    """Return a number of things as text: 1 frame, 2 frames."""
    return f"{count} {thing}{'' if count == 1 else 's'}"


def kept_of(count: int) -> str:
    """Return a text on how many files of an earlier run were kept; empty if none were."""
    return f", {count} of them kept from an earlier run" if count else ""


def show_times(profiles: Sequence[Mapping[str, float]]) -> None:
    """Print the median time of each pass; `profiles` has the milliseconds by pass for each frame."""
    times = {name: median(profile.get(name, 0.0) for profile in profiles) for name in profiles[-1]}
    rows = [(name, f"{time:.2f}") for name, time in (times | {"total": sum(times.values())}).items()]
    show(f"time on the device, median of {counted(len(profiles), 'frame')}", ("pass", "ms"), rows)
