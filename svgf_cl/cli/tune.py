"""``svgf-cl tune``: finds the fastest vector width, exponential, work-group, row alignment and copies for a device."""

from __future__ import annotations

import json as json_
from pathlib import Path
from typing import Annotated, Any

import typer

from svgf_cl.bench.tuner import SECONDS, Trial, Tuner
from svgf_cl.cli.console import progress_bar, show
from svgf_cl.cli.options import Size, check_files, parse_size
from svgf_cl.device.devices import default_queue
from svgf_cl.device.tuning import default_tuning, forget_tuning, store_path, store_tuning
from svgf_cl.frame import Shape
from svgf_cl.io.atomic import output_file, write_text

UNFINISHED = "the search is not finished"
REMEDY = "make the machine idle or choose a smaller --size, and run it again"


def tune(
    size: Size = "1280x720",
    seconds: Annotated[
        float,
        typer.Option(metavar="S", min=0.0, help="Time for the search; candidates that were not tried are reported."),
    ] = SECONDS,
    json: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Also write all trials there as JSON, after each trial."),
    ] = None,
    store: Annotated[bool, typer.Option(help="Store the result, or only print it.")] = True,
    reset: Annotated[bool, typer.Option("--reset", help="Delete the stored result of this device, and exit.")] = False,
) -> None:
    """Find and store the fastest settings of this device.

    Compares vector widths, exponentials, work-groups and alignments of rows with the default on a built-in room, in
    less than a minute. It stores the fastest, which later runs use; if nothing is faster beyond noise, it stores the
    default. The result is for this device with this driver. On devices with memory of their own it then tries copies
    through pinned memory. Pictures stay the same apart from rounding. PYOPENCL_CTX chooses another device.

    If the machine was too busy for a reliable result, nothing is stored and the exit code is 1: there was no time for
    all candidates, or the default's own time varied too much. Then stop other programs or choose a smaller --size,
    and run it again.

    \b
    Examples:
      svgf-cl tune
      PYOPENCL_CTX=1:0 svgf-cl tune --size 1920x1080 --json tune.json
      svgf-cl tune --reset
    """
    shape = parse_size(size)
    output_file(store_path())
    check_files(json)
    queue = default_queue()
    device = queue.device
    print(f"device: {device.name} ({device.platform.version})")
    if reset:
        print(f"untuned again in {forget_tuning(device)}")
        return
    tuner = Tuner(shape, queue, seconds)

    def note(found: str) -> None:
        if json:
            write_text(json, json_.dumps(as_json(tuner, found, size), indent=1))

    with progress_bar("tuning", tuner.steps) as advance:

        def step() -> None:
            advance()
            note(UNFINISHED)

        final = tuner.search(step)
    chosen = final.tuning if final.is_faster else default_tuning(device)
    copies = tuner.race_copies(chosen)
    if copies and copies.is_faster:
        chosen = copies.tuning
    found = "; ".join([verdict(final), *([f"calls from numpy to numpy: {verdict(copies)}"] if copies else [])])
    note(found)
    columns = ("vector", "exponential", "rows", "group", "ms", "Mpixel/s", "time/default")
    show(f"{size}, in the order tried", columns, [trial_row(trial, shape) for trial in tuner.trials])
    for trial in tuner.trials:
        if trial.fault:
            print(f"rejected {trial.tuning}: {trial.fault}")
    print(found)
    if tuner.doubts:
        typer.echo(f"nothing is stored: {', and '.join(tuner.doubts)}; {REMEDY}", err=True)
        raise typer.Exit(1)
    print(f"{chosen}: stored in {store_tuning(device, chosen)}" if store else f"{chosen}: not stored, as asked")


def as_json(tuner: Tuner, found: str, size: str) -> dict[str, Any]:
    """Return the trials of a search so far, for a file."""
    trials = [trial.as_json() for trial in tuner.trials]
    return {"size": size, "verdict": found, "doubts": tuner.doubts, "trials": trials}


def trial_row(trial: Trial, shape: Shape) -> tuple[str, ...]:
    """Return one row of the table; a dash means that it was not timed."""
    tuning = trial.tuning
    group = "{}x{}".format(*tuning.work_group)
    cells = str(tuning.vector_width), tuning.exponential, str(tuning.row_alignment), group
    if not trial.times:
        return (*cells, "-", "-", "-")
    return (*cells, f"{trial.time:.2f}", f"{1e-3 * shape[0] * shape[1] / trial.time:.0f}", f"{trial.ratio:.3f}")


def verdict(final: Trial) -> str:
    """Return the result of the final between a candidate and the default as text."""
    if not final.ratios:
        return "nothing is faster than the default"
    wins = sum(ratio < 1 for ratio in final.ratios)
    found = f"{final.tuning}: {final.ratio:.3f} of the default's time, faster in {wins} of {len(final.ratios)} rounds"
    return found if final.is_faster else f"{found}: within noise, so the default stays"
