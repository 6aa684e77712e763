"""Writes the report: one HTML page that needs no other file, and a picture with all plots."""

from __future__ import annotations

import base64
import io
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import Any

from jinja2 import Environment
from markupsafe import Markup
from matplotlib import rc_context
from matplotlib.figure import Figure

from svgf_cl.bench import plots, scaling
from svgf_cl.bench.compare import comparison, differences
from svgf_cl.bench.results import Run
from svgf_cl.bench.tables import Table, benchmark_table, device_table, memory_table
from svgf_cl.io.atomic import write_text, written_whole

# Placeholder for the page's own text colour, so that plots are legible on dark and light backgrounds.
INK = "#010203"
STYLE: dict[Any, Any] = {
    "svg.fonttype": "none",
    "font.family": "sans-serif",
    "figure.facecolor": "none",
    "axes.facecolor": "none",
    "axes.spines.top": False,
    "axes.spines.right": False,
    **dict.fromkeys(("text.color", "axes.labelcolor", "axes.edgecolor", "xtick.color", "ytick.color"), INK),
}


@dataclass(frozen=True)
class Section:
    """A part of the page.

    Parameters
    ----------
    title : str
    figure : Markup
        The result of `inline_svg` or `inline_png`; may be empty.
    tables : sequence of Table
    notes : sequence of str
        Paragraphs of text.
    """

    title: str
    figure: Markup = Markup()  # noqa: RUF009  # immutable
    tables: Sequence[Table] = ()
    notes: Sequence[str] = ()

    @property
    def is_empty(self) -> bool:
        """Whether there is nothing to show; a table without rows does not count."""
        return not (self.figure or self.notes or any(table.rows for table in self.tables))


def write(
    run: Run, folder: Path, *, old: Run | None = None, first: Sequence[Section] = (), more: Sequence[Section] = ()
) -> None:
    """Write ``report.html`` and ``summary.png``.

    Parameters
    ----------
    run : Run
    folder : Path
    old : Run, optional
        An earlier run to compare with.
    first, more : sequence of Section
        Sections to show before and after the run's own ones.
    """
    write_text(folder / "report.html", render(run, [*first, *sections(run, old), *more]))
    with written_whole(folder / "summary.png") as aside:
        plots.summary(run).savefig(aside, format="png", dpi=100)


def render(run: Run, parts: Sequence[Section]) -> str:
    """Return the page's HTML, without empty parts and tables."""
    template = (resources.files("svgf_cl.bench") / "report.html").read_text(encoding="utf-8")
    return (
        Environment(autoescape=True, trim_blocks=True, lstrip_blocks=True)
        .from_string(template)
        .render(run=run, parts=[part for part in parts if not part.is_empty])
    )


def sections(run: Run, old: Run | None) -> Iterator[Section]:
    """Yield the run's own sections, from top to bottom."""
    yield Section("Devices", tables=[device_table(run), memory_table(run)])
    for title, draw in plots.plots(run).items():
        yield Section(title, inline_svg(draw, title))
    yield Section("Benchmarks", tables=[benchmark_table(run, device) for device in run.devices])
    over = {name: scaling.series(run, name) for name in ("pixels", "iterations", "signals", "cores")}
    yield Section("Scaling", tables=[scaling.table(name, found) for name, found in over.items() if found])
    if old:
        yield Section("Comparison", tables=[comparison(old, run)], notes=differences(old, run))
    yield Section("Left out", notes=run.left_out)


def inline_svg(draw: plots.Draw, title: str) -> Markup:
    """Return a plot as SVG for the page, with a title for people who cannot see it."""
    with rc_context(STYLE | {"svg.hashsalt": title}):  # ids inside are the same in every run, and differ between plots
        figure = Figure(figsize=(9, 4.5), layout="constrained")
        axes = figure.add_subplot()
        draw(axes)
        axes.grid(alpha=0.2)
        buffer = io.StringIO()
        figure.savefig(buffer, format="svg", metadata={"Date": None, "Title": title})
    text = buffer.getvalue()
    return Markup(text[text.index("<svg") :].replace(INK, "currentColor").replace("<svg", '<svg role="img"', 1))


def inline_png(data: bytes, title: str) -> Markup:
    """Return a PNG as HTML for the page."""
    encoded = base64.b64encode(data).decode("ascii")
    return Markup('<img src="data:image/png;base64,{}" alt="{}">').format(encoded, title)
