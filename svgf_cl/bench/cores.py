"""Restricts the process to some of the machine's cores, to measure how time falls with their number.

OpenCL's device fission cannot do this: on one compute unit of two, Intel's runtime kept two threads busy.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

TASKS = Path("/proc/self/task")  # on Linux: the process's threads, including the driver's


def core_counts() -> list[int]:
    """Return 1, 2, 4 and so on up to all cores that this process may use; empty if the system cannot restrict it."""
    if not TASKS.exists():
        return []
    cores = len(os.sched_getaffinity(0))
    return [*(2**power for power in range(cores.bit_length()) if 2**power < cores), cores]


@contextmanager
def confined(count: int) -> Iterator[None]:
    """Restrict all threads to `count` cores in a ``with`` block."""
    every = os.sched_getaffinity(0)
    confine(set(sorted(every)[:count]))
    try:
        yield
    finally:
        confine(every)


def confine(cores: set[int]) -> None:
    """Restrict all threads to these cores."""
    for task in TASKS.iterdir():
        with suppress(ProcessLookupError):  # the thread has ended meanwhile
            os.sched_setaffinity(int(task.name), cores)
