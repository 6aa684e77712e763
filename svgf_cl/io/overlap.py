"""Runs tasks in threads: frames are read in advance, and written while the next ones are filtered.

The code that reads and writes files lets other threads run while it compresses or waits for the disk.
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

    An error of the function is raised here, in the place of its result. If the iteration ends early, items that were
    already taken are still processed, and no others are taken.

    Parameters
    ----------
    function : callable
        May be called from several threads at once.
    items : iterable
        Iterated over in the caller's thread.
    count : int
        At least 1. Up to this many results are in memory, in addition to the one that the caller has.
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
        pool.shutdown()  # waits for the items that were taken
