"""Measurements of the tracer on one scene as tables of text, for the terminal and the report."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from benchmarks.bars import find
from benchmarks.tracing.recording import KINDS
from benchmarks.tracing.rounds import CPU, EMBREE, FRAME, embree
from benchmarks.tracing.split import PARTS
from svgf_cl.bench.results import Result
from svgf_cl.bench.rig import HOST
from svgf_cl.bench.tables import Table, milliseconds, spread

Results = Sequence[Result]


def tables(results: Results) -> list[Table]:
    """Wall time and error, rays, CPU time, start, memory."""
    return [make(results) for make in (frame_table, ray_table, split_table, start_table, memory_table)]


def frame_table(results: Results) -> Table:
    """The frame and its rays alone, with both clocks, and the frame's error."""
    frame = find(results, row=f"tracer {FRAME}", clock=HOST)
    facts, threads = frame.facts, frame.facts["threads"]
    errors = facts["relmse"], facts["psnr"], 1.0 / (facts["relmse"] * frame.median)
    shown = (f"{value:{spec}}" for value, spec in zip(errors, (".3f", ".2f", ".3g"), strict=True))
    rows = [("frame", str(threads), *timed(results, FRAME, threads), *shown)]
    for count in sorted({threads, 1}, reverse=True):
        rows.append(("all its rays, raw Embree", str(count), *timed(results, EMBREE, count), "", "", ""))
    title = f"{frame.device}, {facts['width']}x{facts['height']}, 1 sample per pixel: medians, ratios with 10 % - 90 %"
    times = ("wall ms", "over raw Embree", "CPU ms", "over raw Embree")
    return Table(title, ("", "threads", *times, "relMSE ↓", "PSNR dB ↑", "1 / (relMSE s) ↑"), rows)


def timed(results: Results, what: str, threads: int) -> Iterator[str]:
    """Time and ratio to raw Embree on all threads, with both clocks."""
    for clock in (HOST, CPU):
        found = find(results, row=f"tracer {what}", threads=threads, clock=clock)
        yield spread(found)
        yield ratio(found, find(results, row=f"tracer {EMBREE}", variant="", clock=clock))


def ratio(slow: Result, fast: Result) -> str:
    """How many times as long the slow one took as the fast one in the same round: median, 10th and 90th percentile."""
    low, median, high = np.percentile(np.divide(slow.seconds, fast.seconds), (10, 50, 90))
    return f"{median:.2f} ({low:.2f}-{high:.2f})"


def ray_table(results: Results) -> Table:
    """The number of rays of each kind, and Embree's speed for them."""
    threads = find(results, row=f"tracer {FRAME}").facts["threads"]
    speeds = ("Mray/s, 1 thread", f"Mray/s, {threads} threads", "times faster")
    columns = ("rays", "sent", "asked of Embree in the frame", *speeds)
    rays = {kind: embree(kind) for kind in KINDS} | {"all": EMBREE}
    rows = [
        (name, *ray_row(*(find(results, row=f"tracer {row}", threads=n, clock=HOST) for n in (1, threads))))
        for name, row in rays.items()
    ]
    return Table("rays of that frame, and how fast raw Embree answers all of them in one tree", columns, rows)


def ray_row(one: Result, every: Result) -> tuple[str, ...]:
    """Counts and speeds of one kind, from the times on one thread and on all; no speed if there are no such rays."""
    rays, asked = one.facts["rays"], one.facts["asked"]
    speeds = [f"{1e-6 * rays / each.median:.2f}" for each in (one, every)] if rays else ["", ""]
    return f"{rays:,}", f"{asked:,}", *speeds, f"{one.median / every.median:.2f}" if rays else ""


def split_table(results: Results) -> Table:
    """The parts of the frame's CPU time."""
    medians = split_medians(results)
    whole = sum(medians.values())
    rows = [(part, milliseconds(seconds), f"{100 * seconds / whole:.1f}") for part, seconds in medians.items()]
    return Table("its CPU time", ("spent on", "ms", "%"), [*rows, ("all", milliseconds(whole), "100")])


def split_medians(results: Results) -> dict[str, float]:
    """Seconds of CPU time by part."""
    return {part: find(results, row=f"tracer split {part}").median for part in PARTS}


def start_table(results: Results) -> Table:
    """The time from the scene's name to the first frame, in new processes."""
    starts = {
        "load the scene": "load",
        "of that, build Embree's trees": "trees",
        "first small frame, nothing compiled yet": "cold",
        "first small frame, all compiled before": "warm",
    }
    rows = [(what, f"{find(results, row=f'tracer start {row}').median:.2f}") for what, row in starts.items()]
    return Table("start of a new process", ("", "s"), rows)


def memory_table(results: Results) -> Table:
    """The memory of a new process."""
    facts = find(results, row="tracer start load").facts
    sizes = {
        "Python and libraries": facts["libraries"],
        "the scene": facts["scene"],
        f"at most, with a frame of {facts['width']}x{facts['height']}": facts["peak"],
    }
    return Table("memory of a new process", ("", "MB"), [(what, f"{1e-6 * size:.0f}") for what, size in sizes.items()])
