"""Everything that ``make bench`` measures, in one report.

It runs the benchmark suite, compares speed with OIDN and the tracer with raw Embree, and measures speed against error.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer

from benchmarks import bars, speed_against_error, versus_oidn
from benchmarks.command import run
from benchmarks.footage import FOOTAGE
from benchmarks.tracing import picture
from benchmarks.tracing import suite as tracing
from svgf_cl.bench import report, tables
from svgf_cl.bench.cases import USUAL_SHAPE
from svgf_cl.bench.report import Section
from svgf_cl.bench.results import Result, Run
from svgf_cl.bench.suite import Suite
from svgf_cl.cli.console import progress_bar, show
from svgf_cl.compare import oidn
from svgf_cl.compare.metrics import require_flip
from svgf_cl.errors import SvgfError
from svgf_cl.filters import DEFAULT, Settings
from svgf_cl.io.atomic import output_folder

RACE_ROUNDS = 20
VARIANT_ROUNDS = 10  # half as many as in its own command, because everything has to finish in ten minutes
TRACED, TRACER_ROUNDS = "cornell", 5


def everything(
    output: Annotated[
        Path,
        typer.Option("-o", "--output", metavar="DIR", help="Gets report.html, summary.png, results.json and more."),
    ] = Path("out/bench"),
) -> None:
    """Measure everything and write one report; a first report, without speed against error, is written earlier."""
    require_flip()
    folder = output_folder(output)
    times, race = raced()  # first, because OIDN's memory is measured by the growth of the process
    suite = Suite(re.compile(""), Settings()).run(progress_bar)  # the bars are about passes of this filter
    traced = tracing.measure(TRACED, USUAL_SHAPE, TRACER_ROUNDS, progress_bar)
    run = replace(suite, results=(*suite.results, *times, *traced))
    sections = [race, picture.section(traced)]
    write(run, folder, sections)
    findings = speed_against_error.found(FOOTAGE, VARIANT_ROUNDS)
    findings.write(output_folder(folder / "speed-against-error"))
    sections.append(findings.section)
    write(run, folder, sections)
    shown = [tables.benchmark_table(run, device) for device in run.devices]
    for table in (
        *shown,
        *(table for section in sections for table in section.tables),
        bars.bar_table(run.results, run.platforms),
    ):
        show(table.title, table.columns, table.rows)
    print(f"{folder}: report.html, summary.png, results.json, speed-against-error")


def raced() -> tuple[Sequence[Result], Section]:
    """The times of the comparison with OIDN, and its section of the report.

    Without OIDN, the section has the reason.
    """
    try:
        oidn.require_oidn()
    except SvgfError as error:
        return (), Section(versus_oidn.TITLE, notes=[str(error)])
    found = versus_oidn.compared(USUAL_SHAPE, DEFAULT(), RACE_ROUNDS)
    return found.results, found.section


def write(run: Run, folder: Path, more: list[Section]) -> None:
    """Write results and report."""
    run.write(folder / "results.json")
    held = bars.bar_table(run.results, run.platforms)
    report.write(run, folder, first=[Section("Bars", tables=[held])], more=more)


def main() -> None:
    """Run the command."""
    run(everything, "benchmarks")


if __name__ == "__main__":
    main()
