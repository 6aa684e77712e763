"""The results of a run as tables, files and a section of the benchmark's report."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from functools import cached_property
from pathlib import Path

from benchmarks.measurements import Quality, Result
from benchmarks.presentation import MARK, Column, markdown, oracle_column, plot, quality_columns, table
from svgf_cl.bench.report import Section, inline_png
from svgf_cl.bench.tables import Table
from svgf_cl.io.atomic import write_text, written_whole

TITLE = "Speed against error"

LEGEND = (
    f"{MARK}: on the Pareto front: no other variant is both faster on the device and better by that error.",
    "oracle: error compared with the same filter in float64, relative to the picture's mean.",
    "area: error of jittered rays, compared with light averaged over each pixel; without TAA much of it is aliasing.",
    "centre: error if all rays, also of the truth, go through pixel centres: that of the filter alone, without TAA.",
)


@dataclass(frozen=True)
class Findings:
    """The results of a whole run.

    Parameters
    ----------
    results : sequence of Result
    noise : dict of str to Quality
        The noise of each footage's reference, by name: one half compared with the other.
    about : dict of str to str
        What was measured, on which device, and when.
    """

    results: Sequence[Result]
    noise: dict[str, Quality]
    about: dict[str, str]

    @property
    def tables(self) -> list[Table]:
        """One table for each kind of error."""
        truths = [self._table(f"error against the truth, {name}", quality_columns(name)) for name in self.noise]
        return [self._table("error against the oracle", [oracle_column()]), *truths]

    @property
    def remarks(self) -> list[str]:
        """Notes that explain the figures."""
        facts = (f"{key}: {value}" for key, value in self.about.items())
        return [*LEGEND, *(noise_remark(*pair) for pair in self.noise.items()), *facts]

    @property
    def page(self) -> str:
        """One table with everything, then the notes, in Markdown."""
        columns = [oracle_column(), *(column for name in self.noise for column in quality_columns(name))]
        return markdown(self._table(TITLE, columns)) + "\n" + "".join(f"- {remark}\n" for remark in self.remarks)

    @cached_property
    def plot(self) -> bytes:
        """The plot as PNG."""
        return plot(self.results, list(self.noise), f"{TITLE}, {self.about['size']}")

    def write(self, folder: Path) -> None:
        """Write ``results.json``, ``table.md`` and ``plot.png``."""
        write_text(folder / "results.json", json.dumps(asdict(self), indent=1))
        write_text(folder / "table.md", self.page)
        with written_whole(folder / "plot.png") as aside:
            aside.write_bytes(self.plot)

    @property
    def section(self) -> Section:
        """The section of the benchmark's report."""
        return Section(TITLE, inline_png(self.plot, TITLE), self.tables, self.remarks)

    def _table(self, title: str, columns: Sequence[Column]) -> Table:
        return table(title, self.results, columns)


def noise_remark(name: str, halves: Quality) -> str:
    """The difference between the reference's two halves; the reference is their mean."""
    return (
        f"noise of the truth, {name}: its halves differ by PSNR {halves.psnr:.1f} dB, relMSE {halves.relmse:.4f}, "
        f"FLIP {halves.flip:.4f}, temporal {halves.temporal:.5f}; their mean is 6 dB closer to what they converge to"
    )
