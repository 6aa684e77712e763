"""The report: one HTML page that needs nothing else, and a picture that sums it up."""

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
from svgf_cl.io.atomic import written_whole

# Text and lines take the page's own colour, so that they can be read on dark and on light ground.
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
        Such as `inline_svg` or `inline_png` give; may be empty.
    tables : sequence of Table
    notes : sequence of str
        Paragraphs of text.
    """

    title: str
    figure: Markup = Markup()  # noqa: RUF009  # cannot be changed
    tables: Sequence[Table] = ()
    notes: Sequence[str] = ()

    @property
    def is_empty(self) -> bool:
        """Whether there is nothing to show; a table without rows is nothing."""
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
        What else to show, before and after the run's own sections.
    """
    page = render(run, [*first, *sections(run, old), *more])
    with written_whole(folder / "report.html") as aside:
        aside.write_text(page, encoding="utf-8")
    with written_whole(folder / "summary.png") as aside:
        plots.summary(run).savefig(aside, format="png", dpi=100)


def render(run: Run, parts: Sequence[Section]) -> str:
    """The page's HTML, without empty parts and tables."""
    template = (resources.files("svgf_cl.bench") / "report.html").read_text(encoding="utf-8")
    return (
        Environment(autoescape=True, trim_blocks=True, lstrip_blocks=True)
        .from_string(template)
        .render(run=run, parts=[part for part in parts if not part.is_empty])
    )


def sections(run: Run, old: Run | None) -> Iterator[Section]:
    """The run's own sections, from top to bottom."""
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
    """A plot as SVG to be put into the page, named for those who cannot see it."""
    with rc_context(STYLE | {"svg.hashsalt": title}):  # the same names in every run, others in every plot
        figure = Figure(figsize=(9, 4.5), layout="constrained")
        axes = figure.add_subplot()
        draw(axes)
        axes.grid(alpha=0.2)
        buffer = io.StringIO()
        figure.savefig(buffer, format="svg", metadata={"Date": None, "Title": title})
    text = buffer.getvalue()
    return Markup(text[text.index("<svg") :].replace(INK, "currentColor").replace("<svg", '<svg role="img"', 1))


def inline_png(data: bytes, title: str) -> Markup:
    """A PNG to be put into the page."""
    encoded = base64.b64encode(data).decode("ascii")
    return Markup('<img src="data:image/png;base64,{}" alt="{}">').format(encoded, title)
