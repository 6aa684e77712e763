"""``svgf-cl bench``: how fast the filter is here, how near the device's limits, and how far from the oracle."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Annotated

import typer

from svgf_cl.cli.console import progress_bar, show
from svgf_cl.cli.options import Earlier, FilterName, SettingTexts, parse_settings, parse_size
from svgf_cl.errors import SvgfError
from svgf_cl.filters import DEFAULT
from svgf_cl.io.atomic import output_folder


def bench(
    only: Annotated[str, typer.Option(metavar="REGEX", help="Only benchmarks whose name it is found in.")] = "",
    size: Annotated[
        list[str], typer.Option(metavar="WxH", help="Size to time; may be repeated. By default 320x180 to 3840x2160.")
    ] = [],  # noqa: B006  # never changed; typer wants the default spelled here
    seconds: Annotated[float, typer.Option(metavar="S", min=0.0, help="Time for each denoiser, about.")] = 1.0,
    old: Earlier = None,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o", "--output", metavar="DIR", help="Also write results.json, report.html and summary.png there."
        ),
    ] = None,
    filter_: FilterName = DEFAULT.name,
    set_: SettingTexts = [],  # noqa: B006
) -> None:
    """Time every kernel and the whole frame, against the device's own ceilings, beside the error.

    Runs on every device that works, or on the one that PYOPENCL_CTX names. Input is the camera moving in a built-in
    room, with albedo and ids. Event time is the device's clock, host time the caller's. Names are such as
    kalman.atrous.3.1280x720 and kalman.frame.1280x720. How to read it all: docs/benchmarks.md.

    \b
    Examples:
      svgf-cl bench --only 'frame|enqueue' --size 1280x720
      svgf-cl bench --output out/bench
      svgf-cl bench --only atrous --compare out/bench/results.json
    """
    try:
        from svgf_cl.bench import compare, report, tables
        from svgf_cl.bench.cases import SHAPES
        from svgf_cl.bench.results import Run
        from svgf_cl.bench.suite import Suite
    except ModuleNotFoundError as error:
        raise SvgfError(f"bench needs more ({error}): pip install '.[bench]' in a clone of svgf_cl") from error
    shapes = [parse_size(text) for text in size] or SHAPES
    suite = Suite(parse_pattern(only), parse_settings(filter_, set_), shapes, seconds)
    earlier = Run.read(old) if old else None
    folder = output_folder(output) if output else None
    run = suite.run(progress_bar)
    shown = [tables.device_table(run), *(tables.benchmark_table(run, device) for device in run.devices)]
    if earlier:
        shown.append(compare.comparison(earlier, run))
    for table in shown:
        show(table.title, table.columns, table.rows)
    for line in run.left_out:
        print(f"left out: {line}")
    for line in compare.differences(earlier, run) if earlier else ():
        print(line)
    if folder:
        run.write(folder / "results.json")
        report.write(run, folder, old=earlier)
        print(f"{folder}: results.json, report.html, summary.png")


def parse_pattern(text: str) -> re.Pattern[str]:
    """Read a regular expression; `SvgfError` where it is none."""
    try:
        return re.compile(text)
    except re.error as error:
        raise SvgfError(f"--only: expected a regular expression, got {text!r} ({error})") from error
