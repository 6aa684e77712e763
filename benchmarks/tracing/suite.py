"""All measurements of the tracer on one scene, as results of the benchmark."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from benchmarks.tracing.fresh import STARTS, Fresh, starts
from benchmarks.tracing.noise import noise
from benchmarks.tracing.recording import KINDS, THREADS, Recording, record
from benchmarks.tracing.rounds import CPU, EMBREE, FRAME, embree, sample_round
from benchmarks.tracing.split import split
from svgf_cl.bench.results import Result
from svgf_cl.bench.rig import HOST
from svgf_cl.bench.suite import ProgressBar
from svgf_cl.frame import Shape, extent
from svgf_cl_tracer import Shot, render_frame
from svgf_cl_tracer.cli.scenes import open_scene
from svgf_cl_tracer.references import chunks

# The frame that is timed: from the middle of a sequence, where the camera moves.
FRAMES, NUMBER = 24, 12

REFERENCE_SPP = 64

# The size of the frame whose memory is measured.
MEMORY_SHAPE: Shape = (1080, 1920)

# Seconds of each round, by what was timed, the number of threads, and the clock.
Samples = dict[tuple[str, int, str], list[float]]


def measure(scene: str, shape: Shape, rounds: int, progress_bar: ProgressBar) -> tuple[Result, ...]:
    """Measure the tracer on a scene.

    Parameters
    ----------
    scene : str
        As `svgf_cl_tracer.cli.scenes.open_scene` takes it.
    shape : (int, int)
        The size of the timed frames.
    rounds : int
        >= 1.
    progress_bar : callable
        As in `svgf_cl.bench.suite.Suite.run`.

    Returns
    -------
    tuple of Result
        Of the device "tracer: " followed by the scene's name.

    Raises
    ------
    SvgfError
        If the scene cannot be used.
    """
    shot = Shot(open_scene(scene, None), shape, FRAMES)
    device = f"tracer: {Path(scene).stem}"
    with progress_bar("new processes", STARTS) as advance:
        started = starts(scene, MEMORY_SHAPE, advance)
    with progress_bar("reference", chunks(REFERENCE_SPP)) as advance:
        error = noise(shot, NUMBER, REFERENCE_SPP, advance)
    render_frame(shot, NUMBER)
    recording = record(shot, NUMBER)
    with progress_bar("frames, and Embree by itself", rounds) as advance:
        samples = sampled(shot, recording, rounds, advance)
    facts = counts(recording) | {FRAME: error}
    times = frame_results(device, shape, samples, facts)
    return *times, *start_results(device, started)


def sampled(shot: Shot, recording: Recording, rounds: int, advance: Callable[[], None]) -> Samples:
    """Times of the frame, of its rays, and of all parts of its CPU time."""
    split(shot, NUMBER, recording)  # compiles the loops
    samples: Samples = defaultdict(list)
    for _ in range(rounds):
        for what, threads, clock, seconds in sample_round(shot, NUMBER, recording):
            samples[what, threads, clock].append(seconds)
        for part, seconds in split(shot, NUMBER, recording).items():
            samples[f"split {part}", THREADS, CPU].append(seconds)
        advance()
    return samples


def counts(recording: Recording) -> dict[str, dict[str, int]]:
    """The numbers of rays and of queries to Embree, by what is timed."""
    found = {embree(kind): {"rays": recording.rays(kind), "asked": recording.asked[kind]} for kind in KINDS}
    return found | {EMBREE: {name: sum(each[name] for each in found.values()) for name in ("rays", "asked")}}


def frame_results(
    device: str, shape: Shape, samples: Samples, facts: Mapping[str, Mapping[str, float]]
) -> Iterator[Result]:
    """The samples by name, with the facts about each."""
    for (what, threads, clock), seconds in samples.items():
        variant = "" if threads == THREADS else f"threads{threads}"
        yield result(device, shape, what, clock, seconds, variant=variant, threads=threads, **facts.get(what, {}))


def start_results(device: str, found: Sequence[Fresh]) -> Iterator[Result]:
    """The time from a scene's name to the first frame, and the memory."""
    cold, *warm = found
    times = {
        "load": [each.load for each in found],
        "trees": [each.trees for each in found],
        "cold": [cold.first],
        "warm": [each.first for each in warm],
    }
    memory = {name: max(getattr(each, name) for each in found) for name in ("libraries", "scene", "peak")}
    for what, each in times.items():
        yield result(device, MEMORY_SHAPE, f"start {what}", HOST, each, **memory)


def result(
    device: str, shape: Shape, what: str, clock: str, seconds: Sequence[float], *, variant: str = "", **facts: Any
) -> Result:
    """A result with its name."""
    words = ["tracer", *what.lower().split(), variant, extent(shape)]
    usual = {"row": f"tracer {what}", "height": shape[0], "width": shape[1], "variant": variant}
    return Result(".".join(filter(None, words)), device, clock, tuple(seconds), usual | facts)
