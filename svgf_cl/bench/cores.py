"""The process confined to some of the machine's cores, to see how time falls with their number.

OpenCL's device fission does not serve: on one compute unit of two, Intel's runtime was seen to keep two threads busy.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

TASKS = Path("/proc/self/task")  # of Linux: its threads, the driver's too


def core_counts() -> list[int]:
    """1, 2, 4 and so on up to all cores that this process may use; none where the system cannot confine it."""
    if not TASKS.exists():
        return []
    cores = len(os.sched_getaffinity(0))
    return [*(2**power for power in range(cores.bit_length()) if 2**power < cores), cores]


@contextmanager
def confined(count: int) -> Iterator[None]:
    """Let all threads run on `count` cores only, until the block ends."""
    every = os.sched_getaffinity(0)
    confine(set(sorted(every)[:count]))
    try:
        yield
    finally:
        confine(every)


def confine(cores: set[int]) -> None:
    """Let all threads run on these cores only."""
    for task in TASKS.iterdir():
        with suppress(ProcessLookupError):  # it has ended meanwhile
            os.sched_setaffinity(int(task.name), cores)
