"""All that one frame asks of Embree and of the shading loop, kept so that both can do it again by themselves."""

from __future__ import annotations

import os
import threading
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from dataclasses import dataclass
from typing import Any, NamedTuple, TypeVar

import numpy as np

from benchmarks.tracing.watching import watched
from svgf_cl_tracer import Shot, integrator, render_frame
from svgf_cl_tracer.camera import Lens
from svgf_cl_tracer.paths import Before, Draws, Paths
from svgf_cl_tracer.surroundings import Tables
from svgf_cl_tracer.trees import FAR, Hits, Tree, Trees
from svgf_cl_tracer.vectors import Float32

# What rays are sent for: through a pixel, on from a surface, towards a light.
KINDS = PRIMARY, BOUNCE, SHADOW = "primary", "bounce", "shadow"

# As many as the tracer uses.
THREADS = os.cpu_count() or 1

Item = TypeVar("Item")


@dataclass(frozen=True)
class Batch:
    """Rays that were sent into the scene at once.

    Parameters
    ----------
    kind : str
        One of `KINDS`.
    ask : callable
        What answers them by itself: Embree's own method, but for the names of what it returns, of a single tree over
        the whole scene, in which every surface is solid.
    origin, direction : (N, 3) float32
    distance : (N,) float32
        How far they look; a call overwrites it.
    """

    kind: str
    ask: Callable[[Float32, Float32, Float32], object]
    origin: Float32
    direction: Float32
    distance: Float32


class Shading(NamedTuple):
    """What one call of the shading loop was given."""

    tables: Tables
    lens: Lens
    before: Before
    draws: Draws
    depth: int
    paths: Paths
    hits: Hits


@dataclass(frozen=True)
class Recording:
    """One frame.

    Parameters
    ----------
    sent : tuple of Batch
        All rays of the frame, each once.
    asked : dict of str to int
        By kind, how many of them Embree was asked for: a ray may go to several trees, and on from each hole in a
        surface; and to none, where it passes no box in which it could meet what counts.
    shadings : tuple of Shading
    """

    sent: tuple[Batch, ...]
    asked: Mapping[str, int]
    shadings: tuple[Shading, ...]

    def rays(self, kind: str) -> int:
        """How many rays of a kind the tracer sent."""
        return sum(len(batch.origin) for batch in self.sent if batch.kind == kind)


def record(shot: Shot, number: int) -> Recording:
    """Render frame `number` of a shot as `render_frame` does by default, and keep what it asks for."""
    recorder = Recorder()
    watchers = (
        (integrator, "start_paths", recorder.start),
        (integrator, "escapes", recorder.escape),
        (integrator, "shade", recorder.shade),
        (integrator, "deposit", recorder.deposit),
        (Trees, "occluded", recorder.send),
        (Tree, "nearest", recorder.ask),
        (Tree, "blocked", recorder.ask),
    )
    with ExitStack() as stack:
        for owner, name, watcher in watchers:
            stack.enter_context(watched(owner, name, watcher))
        render_frame(shot, number)
    return Recording(tuple(recorder.batches()), recorder.asked, tuple(recorder.shadings))


class Sent(NamedTuple):
    """A `Batch` before there is a tree: the corners of what is in the scene, and which method of a tree is asked."""

    kind: str
    corners: Float32
    method: str
    rays: tuple[Float32, Float32, Float32]


class Recorder:
    """Watchers of the tracer's functions; several threads call them."""

    def __init__(self) -> None:
        self.asked: Counter[str] = Counter()
        self.shadings: list[Shading] = []
        self._sent: list[Sent] = []
        self._lock = threading.Lock()
        self._now = threading.local()  # of a thread: what its rays are for, and the scene that they were sent into

    def batches(self) -> Iterator[Batch]:
        """What was sent, each scene as one tree."""
        scenes = {id(sent.corners): sent.corners for sent in self._sent}
        trees = {key: Tree(corners, 0, masked=False) for key, corners in scenes.items()}
        for sent in self._sent:
            yield Batch(sent.kind, getattr(trees[id(sent.corners)], sent.method), *sent.rays)

    def start(self, real: Callable[..., None], *arguments: Any) -> None:
        """Of `start_paths`."""
        real(*arguments)
        self._now.kind, self._now.method = PRIMARY, "nearest"

    def escape(self, real: Callable[..., Hits], *arguments: Any) -> Hits:
        """Of `escapes`, which need not know what is nearest."""
        self._now.method = "blocked"
        return real(*arguments)

    def shade(
        self,
        real: Callable[..., tuple[int, int]],
        tables: Tables,
        lens: Lens,
        before: Before,
        draws: Draws,
        depth: int,
        paths: Paths,
        hits: Hits,
        *results: Any,
    ) -> tuple[int, int]:
        """Of `shade`, which uses the memory of its paths again."""
        kept = copied(paths)
        self.shadings.append(Shading(tables, lens, before, draws, depth, kept, hits))
        self._now.corners = tables.triangles.corners
        self._keep(self._now.method, kept.origin, kept.direction, np.full(len(kept.pixel), FAR, np.float32))
        shadows, ahead = real(tables, lens, before, draws, depth, paths, hits, *results)
        self._now.kind, self._now.method = SHADOW if shadows else BOUNCE, "nearest"
        return shadows, ahead

    def deposit(self, real: Callable[..., None], *arguments: Any) -> None:
        """Of `deposit`, which comes after shadow rays."""
        real(*arguments)
        self._now.kind = BOUNCE

    def send(self, real: Callable[..., Any], trees: Trees, *rays: Float32) -> Any:
        """Of `Trees.occluded`, which shadow rays are sent through."""
        if self._now.kind == SHADOW:
            self._keep("blocked", *map(np.copy, rays))
        return real(trees, *rays)

    def ask(self, real: Callable[..., Any], tree: Tree, origin: Float32, *more: Float32) -> Any:
        """Of the methods of `Tree`; one that is being built, which takes a ray of its own, is left alone."""
        if hasattr(self._now, "kind"):
            with self._lock:
                self.asked[self._now.kind] += len(origin)
        return real(tree, origin, *more)

    def _keep(self, method: str, *rays: Float32) -> None:
        self._sent.append(Sent(self._now.kind, self._now.corners, method, (rays[0], rays[1], rays[2])))


def copied(paths: Paths) -> Paths:
    """The same in memory of their own."""
    return Paths(*(np.copy(values) for values in paths))  # type: ignore[arg-type]  # each of its own type


def share_out(work: Callable[[Item], None], items: Iterable[Item], threads: int) -> None:
    """Let so many threads do `work` on all items, each taking the next one."""
    waiting = iter(items)

    def some(_: int) -> None:
        for item in waiting:
            work(item)

    with ThreadPoolExecutor(threads) as pool:
        list(pool.map(some, range(threads)))
