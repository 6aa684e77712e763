"""A round times the frame and its rays, by both clocks."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.tracing.recording import KINDS, PRIMARY, SHADOW, THREADS, Batch, Recording
from benchmarks.tracing.rounds import CPU, EMBREE, FRAME, embree, sample_round, sent_again
from svgf_cl.bench.rig import HOST
from svgf_cl_tracer import Shot
from svgf_cl_tracer.vectors import Float32


def test_what_a_round_times(shot: Shot, recording: Recording) -> None:
    found = {sample[:3]: sample.seconds for sample in sample_round(shot, 3, recording)}
    expected = {(FRAME, THREADS, HOST), (FRAME, THREADS, CPU)}
    for threads in (1, THREADS):
        expected |= {
            (EMBREE, threads, HOST),
            (EMBREE, threads, CPU),
            *((embree(kind), threads, HOST) for kind in KINDS),
        }
    assert found.keys() == expected
    assert all(seconds > 0.0 for (_, _, clock), seconds in found.items() if clock == HOST)


@pytest.mark.parametrize("threads", [1, 2])
def test_all_is_sent_again_with_the_distances_of_the_first_time(threads: int) -> None:
    asked = []

    def ask(origin: Float32, direction: Float32, distance: Float32) -> None:
        asked.append((len(origin), float(distance[0])))
        distance[:] = -1.0  # as Embree does

    rays = np.zeros((3, 3), np.float32), np.ones((3, 3), np.float32)
    batches = tuple(
        Batch(kind, ask, *rays, np.full(3, reach, np.float32)) for kind, reach in ((PRIMARY, 5), (SHADOW, 7))
    )
    for _ in range(2):
        names = [sample.what for sample in sent_again(Recording(batches, {}, ()), threads)]
    assert sorted(asked) == [(3, 5.0), (3, 5.0), (3, 7.0), (3, 7.0)]
    assert names == [EMBREE, EMBREE, *(embree(kind) for kind in KINDS)]
