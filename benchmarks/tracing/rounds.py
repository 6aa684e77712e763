"""A frame's time against what Embree by itself needs for the very same rays, in turns."""

from __future__ import annotations

import time
from collections import defaultdict
from collections.abc import Callable, Iterator
from typing import NamedTuple

from benchmarks.tracing.recording import KINDS, THREADS, Batch, Recording, share_out
from svgf_cl.bench.rig import HOST
from svgf_cl_tracer import Shot, render_frame
from svgf_cl_tracer.vectors import Float32

# The clock of what all threads spend together.
CPU = "cpu"

FRAME, EMBREE = "frame", "embree"


class Sample(NamedTuple):
    """A time.

    Attributes
    ----------
    what : str
        `FRAME`, `EMBREE` for all rays of the frame, or `embree(kind)`.
    threads : int
    clock : str
        `HOST`: from first to last; `CPU`.
    seconds : float
    """

    what: str
    threads: int
    clock: str
    seconds: float


def embree(kind: str) -> str:
    """What Embree's time for a kind of rays is called."""
    return f"{EMBREE} {kind}"


def sample_round(shot: Shot, number: int, recording: Recording) -> Iterator[Sample]:
    """Time the frame once, then raw Embree with all of its rays, on all threads and on one."""
    yield from both_clocks(FRAME, THREADS, lambda: render_frame(shot, number))
    for threads in sorted({THREADS, 1}, reverse=True):
        yield from sent_again(recording, threads)


def both_clocks(what: str, threads: int, work: Callable[[], object]) -> Iterator[Sample]:
    """Time `work` once."""
    begin, begin_cpu = time.perf_counter(), time.process_time()
    work()
    end, end_cpu = time.perf_counter(), time.process_time()
    yield Sample(what, threads, HOST, end - begin)
    yield Sample(what, threads, CPU, end_cpu - begin_cpu)


def sent_again(recording: Recording, threads: int) -> Iterator[Sample]:
    """Send all of a frame's rays to Embree, on so many threads; each kind's time is its part of the whole."""
    spent: dict[str, list[float]] = defaultdict(list)

    def ask(job: tuple[Batch, Float32]) -> None:
        batch, distance = job
        begin = time.perf_counter()
        batch.ask(batch.origin, batch.direction, distance)
        spent[batch.kind].append(time.perf_counter() - begin)

    jobs = [(batch, batch.distance.copy()) for batch in recording.sent]
    yield from both_clocks(EMBREE, threads, lambda: share_out(ask, jobs, threads))
    for kind in KINDS:
        yield Sample(embree(kind), threads, HOST, sum(spent[kind]) / threads)
