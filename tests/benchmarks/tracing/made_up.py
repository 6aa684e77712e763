"""What the benchmark of the tracer might find, for tests of what is made of it."""

from __future__ import annotations

from benchmarks.tracing.fresh import Fresh
from benchmarks.tracing.recording import KINDS, THREADS
from benchmarks.tracing.rounds import CPU, EMBREE, FRAME, embree
from benchmarks.tracing.split import PARTS
from benchmarks.tracing.suite import frame_results, start_results
from svgf_cl.bench.results import Result
from svgf_cl.bench.rig import HOST

COLD, WARM = (Fresh(0.5, 0.2, first, 300_000_000, 50_000_000, 900_000_000) for first in (20.0, 0.4))


def tracer_results(frame_ms: float = 300.0, embree_ms: float = 200.0) -> tuple[Result, ...]:
    """Two rounds of a frame of 1280x720, the second disturbed; Embree takes twice as long on one thread."""
    samples = {}
    for threads in {1, THREADS}:
        ms = embree_ms * THREADS / threads
        samples[EMBREE, threads, HOST] = [1e-3 * ms, 2e-3 * ms]
        samples[EMBREE, threads, CPU] = [1e-3 * embree_ms * THREADS] * 2
        samples.update({(embree(kind), threads, HOST): [1e-3 * ms / len(KINDS)] * 2 for kind in KINDS})
    samples[FRAME, THREADS, HOST] = [1e-3 * frame_ms, 2e-3 * frame_ms]
    samples[FRAME, THREADS, CPU] = [1e-3 * frame_ms * THREADS] * 2
    samples.update({(f"split {part}", THREADS, CPU): [1e-2, 1e-2] for part in PARTS})
    facts = {embree(kind): {"rays": 1_000_000, "asked": 2_000_000} for kind in KINDS}
    facts |= {EMBREE: {"rays": 3_000_000, "asked": 6_000_000}, FRAME: {"relmse": 0.5, "psnr": 19.0}}
    device = "tracer: box"
    return *frame_results(device, (720, 1280), samples, facts), *start_results(device, [COLD, WARM, WARM])
