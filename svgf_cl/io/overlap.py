"""Threads beside the caller's: frames are read before they are asked for, and written while the next are filtered.

What reads and writes files lets other threads run while it compresses or waits for the disk.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from itertools import islice
from typing import TypeVar

Item = TypeVar("Item")
Result = TypeVar("Result")


def in_order(function: Callable[[Item], Result], items: Iterable[Item], count: int) -> Iterator[Result]:
    """Apply a function to items, in up to `count` threads at once, and yield the results in the order of the items.

    What the function raises is raised here, in its place among the results. Where that, or the items, or the caller end
    it early, each item that was taken is still done, and no other is taken.

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
        pool.shutdown()  # what was taken from the items is done
