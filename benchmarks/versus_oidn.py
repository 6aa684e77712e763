"""svgf_cl against Open Image Denoise: the same frames, the same threads, one interleaved run.

In every round each denoiser filters the same frame once, after a warm-up:

- "svgf_cl, whole call": `Denoiser.denoise` from numpy arrays into a numpy array, all copies included.
- "svgf_cl, device": the passes of that same call, from OpenCL events.
- "OIDN ...": ``oidnExecuteFilter`` alone, HDR, with albedo and normal, in place on images that were filled before.

A ratio is that of two times of one round; what counts is its median over the rounds. Memory is what a denoiser holds
beside the images that go in and come out: `Denoiser.nbytes`, and what the process grew by while OIDN was set up and ran
once.
"""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, NamedTuple

import pyopencl as cl
import typer

from benchmarks.bars import BARS
from benchmarks.oidn import QUALITIES, Filter, Images
from benchmarks.provenance import provenance
from benchmarks.race import DEVICE, WHOLE, Spread, race, ratio
from svgf_cl import Denoiser
from svgf_cl.cli.console import progress_bar, show
from svgf_cl.cli.options import SettingTexts, parse_settings, parse_size
from svgf_cl.errors import SvgfError
from svgf_cl.files import written_whole

Times = Mapping[str, Sequence[float]]


class Table(NamedTuple):
    """A title over columns of words."""

    title: str
    headings: Sequence[str]
    rows: Sequence[Sequence[str]]

    def markdown(self) -> str:
        """As it may stand in docs/results.md."""
        lines = [self.headings, ["---"] * len(self.headings), *self.rows]
        return "\n".join([f"{self.title}:", "", *(f"| {' | '.join(line)} |" for line in lines), ""])


def versus_oidn(
    size: Annotated[str, typer.Option(metavar="WxH", help="Size of the timed frames.")] = "1280x720",
    rounds: Annotated[int, typer.Option(metavar="N", min=1, help="Frames that each denoiser filters.")] = 20,
    clean_aux: Annotated[
        bool, typer.Option("--clean-aux", help="Tell OIDN that albedo and normal are free of noise.")
    ] = False,
    set_: SettingTexts = [],  # noqa: B006  # never changed; typer wants the default spelled here
    json_: Annotated[Path | None, typer.Option("--json", metavar="FILE", help="Write all samples there, too.")] = None,
    markdown: Annotated[bool, typer.Option("--markdown", help="Print tables as markdown.")] = False,
) -> None:
    """Time svgf_cl and Open Image Denoise by turns, and hold the ratios against the bars.

    PYOPENCL_CTX chooses svgf_cl's device. OIDN gets as many CPU threads as that device has, or all where it is no CPU.
    """
    shape, settings = parse_size(size), parse_settings(set_)
    den, images = Denoiser(shape, settings=settings), Images(shape)
    threads = threads_of(den.queue.device)
    filters = {f"OIDN {quality}": Filter(images, quality, threads, clean_aux=clean_aux) for quality in QUALITIES}
    with progress_bar(f"svgf_cl against OIDN, {size}", rounds) as advance:
        times = race(den, images, filters, rounds, advance)
    memory = {WHOLE: den.nbytes} | {name: rival.nbytes for name, rival in filters.items()}
    about = provenance(den.queue.device) | {"oidn": filters["OIDN high"].description}
    for table in (time_table(f"{size}, {rounds} rounds", times, memory), ratio_table(times), bar_table(times)):
        print(table.markdown()) if markdown else show(*table)
    print("\n".join(f"{key}: {value}" for key, value in about.items()))
    if json_:
        record = about | {"settings": vars(settings), "size": size, "milliseconds": times, "bytes": memory}
        with written_whole(json_) as aside:
            aside.write_text(json.dumps(record, indent=1), encoding="utf-8")


def threads_of(device: cl.Device) -> int:
    """As many CPU threads as a CPU device has; all where the device is another."""
    is_cpu = bool(device.type & cl.device_type.CPU)
    return device.max_compute_units if is_cpu else os.cpu_count() or 1


def time_table(title: str, times: Times, memory: Mapping[str, int]) -> Table:
    """One row a denoiser: its times and its memory."""
    rows = []
    for name, samples in times.items():
        spread = Spread.of(samples)
        milliseconds = [f"{value:.1f}" for value in (spread.median, spread.low, spread.high)]
        rows.append([name, *milliseconds, f"{memory[name] / 2**20:.0f}" if name in memory else ""])
    return Table(title, ("denoiser", "median ms", "10 %", "90 %", "MiB"), rows)


def ratio_table(times: Times) -> Table:
    """One row a rival: how many times as long it took."""
    rivals = [name for name in times if name not in (WHOLE, DEVICE)]
    rows = [[name, *(f"{ratio(times[name], times[base]):.2f}" for base in (WHOLE, DEVICE))] for name in rivals]
    return Table("Times as long, median (10-90 %) over rounds", ("", WHOLE, DEVICE), rows)


def bar_table(times: Times) -> Table:
    """One row a bar: the ratios that are held against it, and whether it holds."""
    rows = []
    for bar in BARS:
        found = [ratio(times[bar.rival], times[base]) for base in (WHOLE, DEVICE)]
        rows.append([str(bar), *(f"{spread.median:.2f} {bar.verdict(spread)}" for spread in found)])
    return Table("Bars", ("", WHOLE, DEVICE), rows)


def main() -> None:
    """Run the command; wrong input ends in one line, as that of ``svgf-cl`` does."""
    try:
        typer.run(versus_oidn)
    except SvgfError as error:
        print(f"versus_oidn: {error}", file=sys.stderr)
        sys.exit(2)


if __name__ == "__main__":
    main()
