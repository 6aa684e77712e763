"""``python -m benchmarks.tracing``: compares the path tracer with raw Embree, and divides its time into parts."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from benchmarks.command import run as run_command
from svgf_cl.cli.console import progress_bar, show
from svgf_cl.cli.options import Earlier, Size, parse_size
from svgf_cl.errors import SvgfError, install_extra
from svgf_cl.io.atomic import output_folder
from svgf_cl_tracer.cli.render import SCENE_HELP
from svgf_cl_tracer.cli.scenes import require_tracer


def tracing(
    scene: Annotated[str, typer.Argument(metavar="[SCENE]", help=SCENE_HELP)] = "cornell",
    size: Size = "1280x720",
    rounds: Annotated[int, typer.Option(metavar="N", min=1, help="Number of rounds in which everything is timed.")] = 9,
    old: Earlier = None,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="DIR", help="Also write results.json and split.png there."),
    ] = None,
) -> None:
    """Compare the path tracer's time with raw Embree, and show the parts of its time and memory.

    A frame of 1 sample per pixel with its G-buffer, motion, one bounce and shadow rays is rendered, and all its rays
    are traced again by Embree alone, in turns. New processes show start-up time and memory, a reference the noise.

    \b
    Examples:
      python -m benchmarks.tracing
      python -m benchmarks.tracing glossy -o out/glossy
      python -m benchmarks.tracing glossy --compare out/before/results.json
    """
    require_tracer()
    try:
        from benchmarks import bars
        from benchmarks.tracing import picture, suite, tables
        from svgf_cl.bench import compare
        from svgf_cl.bench.results import Run
    except ModuleNotFoundError as error:
        raise SvgfError(f"bench needs more ({error}): {install_extra('bench')}") from error
    shape = parse_size(size)
    earlier = Run.read(old) if old else None
    folder = output_folder(output) if output else None
    run = Run.now((), suite.measure(scene, shape, rounds, progress_bar), ())
    shown = [*tables.tables(run.results), bars.bar_table(run.results, run.platforms)]
    if earlier:
        shown.append(compare.comparison(earlier, run))
    for table in shown:
        show(table.title, table.columns, table.rows)
    if folder:
        run.write(folder / "results.json")
        picture.write(run.results, folder / "split.png")
        print(f"{folder}: results.json, split.png")


def main() -> None:
    """Run the command."""
    run_command(tracing, "benchmarks.tracing")


if __name__ == "__main__":
    main()
