"""Times a frame, and the same rays in Embree alone, in turns."""

from __future__ import annotations

import time
from collections import defaultdict
from collections.abc import Callable, Iterator
from typing import NamedTuple

from benchmarks.tracing.recording import KINDS, THREADS, Batch, Recording, share_out
from svgf_cl.bench.rig import HOST
from svgf_cl_tracer import Shot, render_frame
from svgf_cl_tracer.vectors import Float32

# The clock for the total CPU time of all threads.
CPU = "cpu"

FRAME, EMBREE = "frame", "embree"


class Sample(NamedTuple):
    """One measured time.

    Attributes
    ----------
    what : str
        `FRAME`, `EMBREE` for all rays of the frame, or `embree(kind)`.
    threads : int
    clock : str
        `HOST`: from the first thread's start to the last one's end; or `CPU`.
    seconds : float
    """

    what: str
    threads: int
    clock: str
    seconds: float


def embree(kind: str) -> str:
    """The name of Embree's time for a kind of rays."""
    return f"{EMBREE} {kind}"


def sample_round(shot: Shot, number: int, recording: Recording) -> Iterator[Sample]:
    """Time the frame once, and then all of its rays in raw Embree, on all threads and on one."""
    yield from both_clocks(FRAME, THREADS, lambda: render_frame(shot, number))
    for threads in sorted({THREADS, 1}, reverse=True):
        yield from sent_again(recording, threads)


def both_clocks(what: str, threads: int, work: Callable[[], object]) -> Iterator[Sample]:
    """Time `work` once with both clocks."""
    begin, begin_cpu = time.perf_counter(), time.process_time()
    work()
    end, end_cpu = time.perf_counter(), time.process_time()
    yield Sample(what, threads, HOST, end - begin)
    yield Sample(what, threads, CPU, end_cpu - begin_cpu)


def sent_again(recording: Recording, threads: int) -> Iterator[Sample]:
    """Send all rays of a frame to Embree again, on this many threads.

    The time of each kind is its part of the whole.
    """
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
