"""Threads beside the caller's: frames are read before they are asked for, and written while the next are filtered.

What reads and writes files lets other threads run while it compresses or waits for the disk.
"""

from __future__ import annotations

import warnings
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import AbstractContextManager
from itertools import islice
from types import TracebackType
from typing import ParamSpec, TypeVar

Item = TypeVar("Item")
Result = TypeVar("Result")
Arguments = ParamSpec("Arguments")


def ahead(items: Iterable[Item], count: int) -> Iterator[Item]:
    """Iterate in another thread, up to `count` items before they are asked for.

    What iterating raises is raised here, in its place among the items. Where the caller stops early, be it by Ctrl-C,
    the item in progress is still made, and none after it.

    Parameters
    ----------
    items : iterable
        No other thread may use it meanwhile.
    count : int
        At least 1. As many items are in memory, beside the one that the caller has.
    """
    source, end = iter(items), object()

    def more() -> Item | object:
        return next(source, end)

    pool = ThreadPoolExecutor(1)
    try:
        waiting = deque(pool.submit(more) for _ in range(count))
        while (item := waiting.popleft().result()) is not end:
            waiting.append(pool.submit(more))
            yield item  # type: ignore[misc]  # as it is not the end
    finally:
        pool.shutdown(cancel_futures=True)


def in_order(function: Callable[[Item], Result], items: Iterable[Item], count: int) -> Iterator[Result]:
    """Apply a function to items, in up to `count` threads at once, and yield the results in the order of the items.

    What the function raises is raised here, in its place among the results. Where the caller stops early, the calls in
    progress still end, and none begins.

    Parameters
    ----------
    function : callable
        May be called from several threads at once.
    items : iterable
        Used by the caller's thread.
    count : int
        At least 1. As many results are in memory, beside the one that the caller has.
    """
    source = iter(items)
    pool = ThreadPoolExecutor(count)
    try:
        waiting = deque(pool.submit(function, item) for item in islice(source, count))
        while waiting:
            result = waiting.popleft().result()
            waiting.extend(pool.submit(function, item) for item in islice(source, 1))
            yield result
    finally:
        pool.shutdown(cancel_futures=True)


class Writers(AbstractContextManager["Writers"]):
    """Jobs in threads, at most `count` at a time.

    An error of a job is raised by the next `submit`, or at the end of the ``with`` block; of several, that of the job
    that was submitted first. Every job that was submitted is done by the end of the block, however it ends. Errors that
    cannot be raised there, because another one is on its way, are told as warnings.

    Parameters
    ----------
    count : int
        At least 1.
    """

    def __init__(self, count: int) -> None:
        self._count = count
        self._pool = ThreadPoolExecutor(count)
        self._running: deque[Future[object]] = deque()

    def submit(self, job: Callable[Arguments, object], *args: Arguments.args, **kwargs: Arguments.kwargs) -> None:
        """Call a function in a thread; where all threads are busy, wait for the job that was submitted first."""
        while self._running and (len(self._running) == self._count or self._running[0].done()):
            self._running.popleft().result()
        self._running.append(self._pool.submit(job, *args, **kwargs))

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        """Wait for all jobs, and raise the first error unless the block raised one."""
        self._pool.shutdown()
        failures = [failure for job in self._running if (failure := job.exception())]
        raised = failures[:1] if error is None else []
        for failure in failures[len(raised) :]:
            warnings.warn(str(failure), stacklevel=2)
        for failure in raised:
            raise failure
