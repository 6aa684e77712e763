"""Results as a table and as a plot; both mark the Pareto front of time and each error."""

from __future__ import annotations

import io
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from benchmarks.markdown import markdown as in_markdown
from benchmarks.measurements import Result
from benchmarks.pareto import pareto_front
from svgf_cl.bench.tables import Table

# Mark for figures that no other variant beats in both time and error.
MARK = "•"


@dataclass(frozen=True)
class Column:
    """A kind of error, and its format.

    Parameters
    ----------
    title : str
        With an arrow in the direction of better figures.
    of : callable
        The figure of a result; NaN if it was not measured.
    spec : str
        Its format. Front and plot use the figures as printed, so that an invisible difference has no effect.
    plotted : bool
    """

    title: str
    of: Callable[[Result], float]
    spec: str
    plotted: bool = True

    def text(self, result: Result) -> str:
        """The figure as printed."""
        value = self.of(result)
        return "" if math.isnan(value) else format(value, self.spec)

    def point(self, result: Result) -> tuple[float, float]:
        """Time and figure, both as printed."""
        return float(milliseconds(result.times.device)), float(self.text(result))

    def front(self, results: Sequence[Result]) -> list[Result]:
        """The results on the Pareto front of device time and this error, the fastest first."""
        sign = -1 if "↑" in self.title else 1
        measured = [result for result in results if self.text(result)]
        points = [(time, sign * figure) for time, figure in map(self.point, measured)]
        return [measured[index] for index in pareto_front(points)]


def oracle_column() -> Column:
    """Difference from the oracle."""
    return Column("oracle rms ↓", lambda result: result.oracle_rms, ".2e")


def quality_columns(footage: str) -> list[Column]:
    """Errors compared with the truth of the footage of this name."""

    def of(metric: str) -> Callable[[Result], float]:
        return lambda result: getattr(result.quality.get(footage), metric, math.nan)

    return [
        Column(f"{footage} PSNR dB ↑", of("psnr"), ".2f"),
        Column(f"{footage} relMSE ↓", of("relmse"), ".4f", plotted=False),
        Column(f"{footage} FLIP ↓", of("flip"), ".4f"),
        Column(f"{footage} temporal ↓", of("temporal"), ".5f"),
    ]


def milliseconds(time: float) -> str:
    """A time as printed."""
    return f"{time:.1f}"


def table(title: str, results: Sequence[Result], columns: Sequence[Column]) -> Table:
    """A row for each variant that has any of the figures; figures on their Pareto front are marked."""
    fronts = [column.front(results) for column in columns]

    def row(number: int, result: Result) -> list[str]:
        marks = [f" {MARK}" if result in front else "" for front in fronts]
        errors = [column.text(result) + mark for column, mark in zip(columns, marks, strict=True)]
        times = [milliseconds(result.times.device), milliseconds(result.times.frame)]
        return [f"{number} {result.variant.name}", *times, *errors]

    headings = ["variant", "device ms", "frame ms", *(column.title for column in columns)]
    measured = [pair for pair in enumerate(results, 1) if any(column.text(pair[1]) for column in columns)]
    return Table(title, headings, [row(*pair) for pair in measured])


def markdown(table: Table) -> str:
    """The table in Markdown for docs/results.md, without its title."""
    return in_markdown(table.columns, table.rows)


def plot(results: Sequence[Result], footages: Sequence[str], title: str) -> bytes:
    """A PNG: a row of panels for each footage, then the panel of the oracle and the names."""
    shown = {name: [column for column in quality_columns(name) if column.plotted] for name in footages}
    width = 1 + max(len(columns) for columns in shown.values())
    figure = Figure(figsize=(4 * width, 4 * len(shown)), layout="constrained")
    grid = figure.subplots(len(shown), width, squeeze=False)
    for line, columns in zip(grid, shown.values(), strict=True):
        for axes, column in zip(line, columns, strict=False):
            panel(axes, column, results)
    grid[0, -1].set_yscale("log")  # errors range from rounding to those of "fast" and 16 bits
    panel(grid[0, -1], oracle_column(), results)
    for axes in grid[1:, -1]:
        axes.axis("off")
    names(grid[-1, -1], results)
    figure.suptitle(title)
    drawing = io.BytesIO()
    figure.savefig(drawing, format="png", dpi=110)
    return drawing.getvalue()


def panel(axes: Axes, column: Column, results: Sequence[Result]) -> None:
    """Draw every result with its number, the front as steps, and the default in red."""
    front = column.front(results)
    corners = [column.point(result) for result in front]
    axes.step([time for time, _ in corners], [figure for _, figure in corners], where="post", color="grey")
    for number, result in enumerate(results, 1):
        if not column.text(result):
            continue
        place = column.point(result)
        color = "tab:red" if number == 1 else "tab:blue"
        fill, ink = (color, "white") if result in front else ("white", color)
        layer = 2 + 1 / number  # if they overlap, the default is on top
        axes.plot(*place, "o", markersize=13, color=color, markerfacecolor=fill, zorder=layer)
        axes.annotate(str(number), place, ha="center", va="center_baseline", color=ink, fontsize=8, zorder=layer)
    axes.set_xlabel("device ms a frame")
    axes.set_ylabel(column.title)
    axes.margins(0.08)
    axes.grid(alpha=0.3)


def names(axes: Axes, results: Sequence[Result]) -> None:
    """The names of the numbered variants, and the meaning of the markers."""
    handles = [
        Line2D([], [], marker="o", linestyle="-", color="grey", label="on the Pareto front"),
        Line2D([], [], marker="o", linestyle="", color="grey", markerfacecolor="white", label="not on it"),
    ]
    lines = [f"{number}  {result.variant.name}" for number, result in enumerate(results, 1)]
    axes.legend(handles=handles, title="\n".join(lines), loc="upper left", alignment="left", frameon=False)
