"""Divides the CPU time of a frame into parts.

The frame's stages are timed while it runs. The shading loop does all its work for one path after the other, so its
parts are timed alone, over the same paths and hits; the time of the G-buffer is the saving without it. Their shares of
the whole loop, when it is run again alone, are multiplied by the loop's time in the frame. The rest is shading.
"""

from __future__ import annotations

import threading
import time
from collections import defaultdict
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from functools import partial
from typing import Any

import numpy as np

from benchmarks.tracing.loops import Spots, draw_numbers, find_spots, read_textures, sample_lights
from benchmarks.tracing.recording import THREADS, Recording, Shading, share_out
from benchmarks.tracing.watching import watched
from svgf_cl_tracer import Shot, integrator, render, render_frame
from svgf_cl_tracer.paths import Features, Paths, ShadowRays
from svgf_cl_tracer.shading import shade
from svgf_cl_tracer.trees import Tree, Trees

PARTS = EMBREE, MASKS, SHADING, LIGHTS, NUMBERS, TEXTURES, G_BUFFER, ENDS, REST = (
    "Embree",
    "alpha masks",
    "shading",
    "light sampling",
    "random numbers",
    "textures",
    "G-buffer",
    "camera rays and sums",
    "rest",
)

# The functions of each part, without those that belong to another part.
STAGES: dict[str, tuple[tuple[object, str], ...]] = {
    EMBREE: ((Tree, "__init__"), (Tree, "nearest"), (Tree, "blocked")),
    MASKS: ((Trees, "intersect"), (Trees, "occluded")),
    SHADING: ((integrator, "shade"),),
    ENDS: (
        (integrator, "start_paths"),
        (integrator, "deposit"),
        (render, "pick_moments"),
        (render, "sum_up"),
    ),
}

Seconds = dict[str, float]


class Tally:
    """Adds up the CPU time of parts over all threads, and counts each moment once."""

    def __init__(self) -> None:
        self.seconds: Seconds = defaultdict(float)
        self._lock, self._threads = threading.Lock(), threading.local()

    def timed(self, part: str) -> Callable[..., Any]:
        """A watcher that counts the time of calls as `part`, without the watched calls inside."""

        def watcher(real: Callable[..., Any], *arguments: Any, **options: Any) -> Any:
            beside, self._threads.within = getattr(self._threads, "within", 0.0), 0.0
            begin = time.thread_time()
            result = real(*arguments, **options)
            spent = time.thread_time() - begin
            with self._lock:
                self.seconds[part] += spent - self._threads.within
            self._threads.within = beside + spent
            return result

        return watcher


def split(shot: Shot, number: int, recording: Recording) -> Seconds:
    """Render a frame once, and divide its CPU time, in s, into `PARTS`; `recording` is of the same frame."""
    stages, shares = stage_times(shot, number), loop_shares(recording)
    loop = stages[SHADING]
    parts = stages | {part: share * loop for part, share in shares.items()}
    parts[SHADING] = loop * (1.0 - sum(shares.values()))
    return {part: parts[part] for part in PARTS}


def stage_times(shot: Shot, number: int) -> Seconds:
    """Seconds of a frame's stages while it runs; the whole shading loop is `SHADING`."""
    tally = Tally()
    with ExitStack() as stack:
        for part, functions in STAGES.items():
            for owner, name in functions:
                stack.enter_context(watched(owner, name, tally.timed(part)))
        begin = time.process_time()
        render_frame(shot, number)
        whole = time.process_time() - begin
    seconds = {part: tally.seconds[part] for part in STAGES}
    return seconds | {REST: whole - sum(seconds.values())}


def loop_shares(recording: Recording) -> Seconds:
    """The shares of parts in the time of the shading loop."""
    calls = recording.shadings
    whole, without_g_buffer = cpu_time(again, calls), cpu_time(without_features, calls)
    alone = {part: cpu_time(prepare, calls) for part, prepare in ALONE.items()}
    return {part: seconds / whole for part, seconds in {**alone, G_BUFFER: whole - without_g_buffer}.items()}


def cpu_time(prepare: Callable[[Shading], Callable[[], object]], calls: Sequence[Shading]) -> float:
    """CPU seconds of the functions that `prepare` makes from the calls, on all cores, without the preparation."""
    tally = Tally()
    share_out(lambda call: tally.timed("")(prepare(call)), calls, THREADS)
    return tally.seconds[""]


def again(call: Shading) -> Callable[[], object]:
    """The loop with its original arguments."""
    return shading(call, Features.empty(len(call.draws.pixels)))


def without_features(call: Shading) -> Callable[[], object]:
    """The loop without the G-buffer."""
    return shading(call, Features.empty(0))


def shading(call: Shading, features: Features) -> Callable[[], object]:
    """The loop with memory for its results."""
    count = len(call.draws.pixels)
    light = np.zeros((count, 5, 3), np.float32)
    return partial(shade, *call, light, features, ShadowRays.empty(count), Paths.empty(count))


def drawing(call: Shading) -> Callable[[], object]:
    """Only the random numbers of the loop."""
    return partial(draw_numbers, call.draws, call.depth, call.paths, spots(call))


def reading(call: Shading) -> Callable[[], object]:
    """Only the textures of the loop."""
    return partial(read_textures, call.tables, spots(call))


def lighting(call: Shading) -> Callable[[], object]:
    """Only the lights of the loop."""
    return partial(sample_lights, call.tables, call.paths, spots(call))


def spots(call: Shading) -> Spots:
    """The paths of a call of the loop."""
    found = Spots.empty(len(call.paths.pixel))
    find_spots(call.tables, call.draws, call.depth, call.paths, call.hits, found)
    return found


ALONE = {LIGHTS: lighting, NUMBERS: drawing, TEXTURES: reading}
