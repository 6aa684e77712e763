"""All that one frame asks of Embree and of the shading loop, kept so that both can do it again by themselves."""

from __future__ import annotations

import os
import threading
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from dataclasses import dataclass
from functools import partial
from typing import Any, NamedTuple, TypeVar

import numpy as np

from svgf_cl.bench.tracing.watching import watched
from tracer import Shot, integrator, render_frame
from tracer.camera import Lens
from tracer.paths import Before, Draws, Paths
from tracer.scene import Tables
from tracer.trees import Hits, Tree, Trees
from tracer.vectors import Float32

# What rays are sent for: through a pixel, on from a surface, towards a light.
KINDS = PRIMARY, BOUNCE, SHADOW = "primary", "bounce", "shadow"

# As many as the tracer uses.
THREADS = os.cpu_count() or 1

Item = TypeVar("Item")


@dataclass(frozen=True)
class Query:
    """One call of Embree.

    Parameters
    ----------
    kind : str
        One of `KINDS`.
    ask : callable
        The method of the `Tree` that was called, which is Embree's own but for the names of what it returns.
    origin, direction : (N, 3) float32
    distance : (N,) float32
        As it was before the call, which overwrites it.
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
    sent : tuple of (str, int)
        The batches of rays that the tracer sent into the scene: their kind, and how many.
    asked : tuple of Query
        What became of that: a ray may go to several trees, and on from each hole in a surface.
    shadings : tuple of Shading
    """

    sent: tuple[tuple[str, int], ...]
    asked: tuple[Query, ...]
    shadings: tuple[Shading, ...]

    def rays(self, kind: str) -> int:
        """How many rays of a kind the tracer sent."""
        return sum(count for name, count in self.sent if name == kind)

    def queries(self, kind: str) -> int:
        """How many rays Embree was asked for on their behalf."""
        return sum(len(query.origin) for query in self.asked if query.kind == kind)


def record(shot: Shot, number: int) -> Recording:
    """Render frame `number` of a shot as `render_frame` does by default, and keep what it asks for."""
    recorder = Recorder()
    watchers = (
        (integrator, "start_paths", recorder.start),
        (integrator, "shade", recorder.shade),
        (integrator, "deposit", recorder.deposit),
        (Trees, "intersect", recorder.send),
        (Trees, "occluded", recorder.send),
        (Tree, "nearest", recorder.ask),
        (Tree, "blocked", recorder.ask),
    )
    with ExitStack() as stack:
        for owner, name, watcher in watchers:
            stack.enter_context(watched(owner, name, watcher))
        render_frame(shot, number)
    return Recording(tuple(recorder.sent), tuple(recorder.asked), tuple(recorder.shadings))


class Recorder:
    """Watchers of the tracer's functions; several threads call them."""

    def __init__(self) -> None:
        self.sent: list[tuple[str, int]] = []
        self.asked: list[Query] = []
        self.shadings: list[Shading] = []
        self._next = threading.local()  # what the rays are for that a thread will send next

    def start(self, real: Callable[..., None], *arguments: Any) -> None:
        """Of `start_paths`."""
        real(*arguments)
        self._next.kind = PRIMARY

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
        self.shadings.append(Shading(tables, lens, before, draws, depth, copied(paths), hits))
        shadows, ahead = real(tables, lens, before, draws, depth, paths, hits, *results)
        self._next.kind = SHADOW if shadows else BOUNCE
        return shadows, ahead

    def deposit(self, real: Callable[..., None], *arguments: Any) -> None:
        """Of `deposit`, which comes after shadow rays."""
        real(*arguments)
        self._next.kind = BOUNCE

    def send(self, real: Callable[..., Any], trees: Trees, origin: Float32, *more: Float32) -> Any:
        """Of the methods of `Trees`."""
        self.sent.append((self._next.kind, len(origin)))
        return real(trees, origin, *more)

    def ask(self, real: Callable[..., Any], tree: Tree, *rays: Float32) -> Any:
        """Of the methods of `Tree`; one that is being built, which takes a ray of its own, is left alone."""
        if hasattr(self._next, "kind"):
            self.asked.append(Query(self._next.kind, partial(real, tree), *map(np.copy, rays)))
        return real(tree, *rays)


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
