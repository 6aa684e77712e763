"""``svgf-cl bench``: measures the filter's speed, the device's limits, and the error against the oracle."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Annotated

import typer

from svgf_cl.cli.console import progress_bar, show
from svgf_cl.cli.options import STDOUT, Earlier, FilterName, SettingTexts, check_files, parse_settings, parse_size
from svgf_cl.cli.verdict import leave_with
from svgf_cl.errors import SvgfError, install_extra
from svgf_cl.filters import DEFAULT
from svgf_cl.io.atomic import output_folder


def check_ratio(value: float | None) -> float | None:
    """Return the ratio; raise an error unless it is a finite number above 0."""
    if value is not None and not 0 < value < math.inf:  # NaN, too
        raise typer.BadParameter(f"expected a ratio > 0 such as 1.10, got {value:g}")
    return value


def bench(
    only: Annotated[str, typer.Option(metavar="REGEX", help="Only benchmarks whose name matches.")] = "",
    size: Annotated[
        list[str], typer.Option(metavar="WxH", help="Size to time; may be repeated. By default 320x180 to 3840x2160.")
    ] = [],  # noqa: B006  # never changed; typer needs the default here
    seconds: Annotated[float, typer.Option(metavar="S", min=0.0, help="Approximate time for each denoiser.")] = 1.0,
    ceilings: Annotated[bool, typer.Option(help="Measure the limits of the devices, and show rooflines.")] = True,
    list_: Annotated[
        bool, typer.Option("--list", help="Only print the names that would be timed, without the ceilings.")
    ] = False,
    old: Earlier = None,
    fail_above: Annotated[
        float | None,
        typer.Option(
            metavar="RATIO",
            help="With --compare: exit code 1 if a pass or frame takes more than this many times as long as before, "
            "beyond the spread of both runs.",
            callback=check_ratio,
        ),
    ] = None,
    junit: Annotated[
        Path | None, typer.Option(metavar="FILE", help="With --fail-above: also write the checks as JUnit XML.")
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o", "--output", metavar="DIR", help="Also write results.json, report.html and summary.png there."
        ),
    ] = None,
    json: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE", help="Also write the results there as JSON; '-' prints them on stdout instead of tables."
        ),
    ] = None,
    filter_: FilterName = DEFAULT.name,
    set_: SettingTexts = [],  # noqa: B006
) -> None:
    """Time kernels and frames; compare them with the device's limits.

    Runs on every device that works, or on the one that PYOPENCL_CTX names. The input is a camera that moves in a
    built-in room, with albedo and ids. Event time is measured by the device, host time by the caller. Examples of
    names are kalman.atrous.3.1280x720 and kalman.frame.1280x720. docs/benchmarks.md explains the results.

    The exit code is 1 if --fail-above finds something slower, with a line for each on stderr. If the two runs have
    nothing in common that can be checked, that is an error.

    \b
    Examples:
      svgf-cl bench --only 'frame|enqueue' --size 1280x720
      svgf-cl bench --output out/bench
      svgf-cl bench --only atrous --compare out/bench/results.json
      svgf-cl bench --compare out/bench/results.json --fail-above 1.10 --junit out/bench.xml
      svgf-cl bench --no-ceilings --json - > results.json
      svgf-cl bench --list --only 1280x720
    """
    try:
        from svgf_cl.bench import compare, regressions, report, tables
        from svgf_cl.bench.cases import SHAPES
        from svgf_cl.bench.results import Run
        from svgf_cl.bench.suite import Suite
    except ModuleNotFoundError as error:
        raise SvgfError(f"bench needs more ({error}): {install_extra('bench')}") from error
    check_gate(old, fail_above, junit)
    shapes = [parse_size(text) for text in size] or SHAPES
    suite = Suite(parse_pattern(only), parse_settings(filter_, set_), shapes, seconds, ceilings)
    if list_:
        print(*suite.names(), sep="\n")
        return
    earlier = Run.read(old) if old else None
    folder = output_folder(output) if output else None
    check_files(json, junit)
    run = suite.run(progress_bar)
    piped = json == STDOUT
    shown = [tables.device_table(run), *(tables.benchmark_table(run, device) for device in run.devices)]
    notes = [f"left out: {line}" for line in run.left_out]
    if earlier:
        shown.append(compare.comparison(earlier, run))
        notes += compare.differences(earlier, run)
    for table in shown:
        if table.rows and not piped:
            show(table.title, table.columns, table.rows)
    if piped:
        print(run.text)
    elif json:
        run.write(json)
    if folder:
        run.write(folder / "results.json")
        report.write(run, folder, old=earlier)
        notes.append(f"{folder}: results.json, report.html, summary.png")
    for note in notes:
        typer.echo(note, err=piped)
    if earlier and fail_above:
        leave_with(regressions.checks(earlier, run, fail_above), "svgf-cl bench", junit)


def check_gate(old: Path | None, fail_above: float | None, junit: Path | None) -> None:
    """Raise `SvgfError` if an option lacks another that it needs."""
    if fail_above and not old:
        raise SvgfError("--fail-above: expected --compare OLD.json too, got none")
    if junit and not fail_above:
        raise SvgfError("--junit: expected --fail-above RATIO too, got none")


def parse_pattern(text: str) -> re.Pattern[str]:
    """Read a regular expression; raise `SvgfError` if it is invalid."""
    try:
        return re.compile(text)
    except re.error as error:
        raise SvgfError(f"--only: expected a regular expression, got {text!r} ({error})") from error
