"""The split of a frame's CPU time as a picture, and the section of the report about the tracer."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from benchmarks.tracing.tables import split_medians, tables
from svgf_cl.bench.plots import COLORS
from svgf_cl.bench.report import Section, inline_svg
from svgf_cl.bench.results import Result
from svgf_cl.io.atomic import written_whole

PALETTE = (*COLORS, "#8C564B")


def section(results: Sequence[Result]) -> Section:
    """The picture and the tables of one scene's results."""
    title = f"The {results[0].device}"
    return Section(title, inline_svg(partial(draw, results=results), title), tables(results))


def write(results: Sequence[Result], path: Path) -> None:
    """Write the picture of one scene's results as PNG."""
    figure = Figure(figsize=(9, 2.8), layout="constrained")
    axes = figure.add_subplot()
    draw(axes, results)
    axes.set_title(results[0].device)
    with written_whole(path) as aside:
        figure.savefig(aside, format="png", dpi=110)


def draw(axes: Axes, results: Sequence[Result]) -> None:
    """A bar of the frame's CPU time, part by part."""
    left = 0.0
    for color, (part, seconds) in zip(PALETTE, split_medians(results).items(), strict=True):
        axes.barh(0, 1e3 * seconds, left=left, color=color, edgecolor="white", linewidth=0.5, label=part)
        left += 1e3 * seconds
    axes.set_yticks([])
    axes.set_xlabel("ms of CPU time a frame")
    axes.legend(fontsize="small", ncols=5, loc="upper center", bbox_to_anchor=(0.5, -0.25), frameon=False)
