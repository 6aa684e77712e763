"""Records all queries to Embree and all calls of the shading loop in a frame, so that both can be repeated alone."""

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

# The purposes of rays: through a pixel, on from a surface, towards a light.
KINDS = PRIMARY, BOUNCE, SHADOW = "primary", "bounce", "shadow"

# As many threads as the tracer uses.
THREADS = os.cpu_count() or 1

Item = TypeVar("Item")


@dataclass(frozen=True)
class Batch:
    """Rays that were sent together.

    Parameters
    ----------
    kind : str
        One of `KINDS`.
    ask : callable
        Traces them: the method of Embree that the tracer used (only the names of its results differ), on a single tree
        of the whole scene in which every surface is solid.
    origin, direction : (N, 3) float32
    distance : (N,) float32
        The largest distance; a call overwrites it.
    """

    kind: str
    ask: Callable[[Float32, Float32, Float32], object]
    origin: Float32
    direction: Float32
    distance: Float32


class Shading(NamedTuple):
    """The arguments of one call of the shading loop."""

    tables: Tables
    lens: Lens
    before: Before
    draws: Draws
    depth: int
    paths: Paths
    hits: Hits


@dataclass(frozen=True)
class Recording:
    """The recording of one frame.

    Parameters
    ----------
    sent : tuple of Batch
        All rays of the frame, each one once.
    asked : dict of str to int
        The number of queries to Embree, by kind. A ray may be sent to several trees, and again behind each hole in a
        surface; or to no tree, if it passes no box where a hit would matter.
    shadings : tuple of Shading
    """

    sent: tuple[Batch, ...]
    asked: Mapping[str, int]
    shadings: tuple[Shading, ...]

    def rays(self, kind: str) -> int:
        """The number of rays of a kind that the tracer sent."""
        return sum(len(batch.origin) for batch in self.sent if batch.kind == kind)


def record(shot: Shot, number: int) -> Recording:
    """Render frame `number` of a shot as `render_frame` does by default, and record it."""
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
    """A `Batch` before its tree is built: the corners of the scene's triangles, and the method of the tree."""

    kind: str
    corners: Float32
    method: str
    rays: tuple[Float32, Float32, Float32]


class Recorder:
    """Watchers for the tracer's functions; several threads call them."""

    def __init__(self) -> None:
        self.asked: Counter[str] = Counter()
        self.shadings: list[Shading] = []
        self._sent: list[Sent] = []
        self._lock = threading.Lock()
        self._now = threading.local()  # per thread: the purpose of its rays, and their scene

    def batches(self) -> Iterator[Batch]:
        """The recorded rays, with one tree for each scene."""
        scenes = {id(sent.corners): sent.corners for sent in self._sent}
        trees = {key: Tree(corners, 0, masked=False) for key, corners in scenes.items()}
        for sent in self._sent:
            yield Batch(sent.kind, getattr(trees[id(sent.corners)], sent.method), *sent.rays)

    def start(self, real: Callable[..., None], *arguments: Any) -> None:
        """Watches `start_paths`."""
        real(*arguments)
        self._now.kind, self._now.method = PRIMARY, "nearest"

    def escape(self, real: Callable[..., Hits], *arguments: Any) -> Hits:
        """Watches `escapes`, which needs no nearest hit."""
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
        """Watches `shade`, which reuses the memory of its paths."""
        kept = copied(paths)
        self.shadings.append(Shading(tables, lens, before, draws, depth, kept, hits))
        self._now.corners = tables.triangles.corners
        self._keep(self._now.method, kept.origin, kept.direction, np.full(len(kept.pixel), FAR, np.float32))
        shadows, ahead = real(tables, lens, before, draws, depth, paths, hits, *results)
        self._now.kind, self._now.method = SHADOW if shadows else BOUNCE, "nearest"
        return shadows, ahead

    def deposit(self, real: Callable[..., None], *arguments: Any) -> None:
        """Watches `deposit`, which is called after shadow rays."""
        real(*arguments)
        self._now.kind = BOUNCE

    def send(self, real: Callable[..., Any], trees: Trees, *rays: Float32) -> Any:
        """Watches `Trees.occluded`, which traces shadow rays."""
        if self._now.kind == SHADOW:
            self._keep("blocked", *map(np.copy, rays))
        return real(trees, *rays)

    def ask(self, real: Callable[..., Any], tree: Tree, origin: Float32, *more: Float32) -> Any:
        """Watches the methods of `Tree`, except while a tree is built, which sends a ray of its own."""
        if hasattr(self._now, "kind"):
            with self._lock:
                self.asked[self._now.kind] += len(origin)
        return real(tree, origin, *more)

    def _keep(self, method: str, *rays: Float32) -> None:
        self._sent.append(Sent(self._now.kind, self._now.corners, method, (rays[0], rays[1], rays[2])))


def copied(paths: Paths) -> Paths:
    """A copy of the paths."""
    return Paths(*(np.copy(values) for values in paths))  # type: ignore[arg-type]  # each of its own type


def share_out(work: Callable[[Item], None], items: Iterable[Item], threads: int) -> None:
    """Do `work` on all items in this many threads; each thread takes the next item."""
    waiting = iter(items)

    def some(_: int) -> None:
        for item in waiting:
            work(item)

    with ThreadPoolExecutor(threads) as pool:
        list(pool.map(some, range(threads)))
