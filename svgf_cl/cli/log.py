"""Shows progress in a file or on a render farm: as a line from time to time."""

from __future__ import annotations

import os
import sys
from datetime import timedelta
from time import monotonic

SECONDS = 10.0  # between two lines
OPENJD = "OPENJD_SESSION_WORKING_DIR"  # a variable that is set under Open Job Description


class Log:
    """Shows progress as lines on stderr: at most one in `SECONDS`, and none for a shorter task.

    Parameters
    ----------
    title : str
        Name of the task.
    total : int
        Number of its steps.
    resumed : bool
        Whether the steps of the first report were done before; they do not count for the estimate of the time left.
    """

    def __init__(self, title: str, total: int, *, resumed: bool = False) -> None:
        self._title, self._total = title, total
        self._began = self._last = monotonic()
        self._start = None if resumed else 0.0

    def report(self, done: float, remark: str = "") -> None:
        """Note how many steps are done, and write a line if it is time for one."""
        now = monotonic()
        if self._start is None:
            self._start = done
        if now - self._last < SECONDS or done <= self._start or sys.stderr is None:
            return
        self._last = now
        left = timedelta(seconds=round((now - self._began) * (self._total - done) / (done - self._start)))
        parts = (f"{self._title} {int(done)} of {self._total}", remark, f"{left} left")
        for line in lines(100.0 * done / self._total, ", ".join(part for part in parts if part)):
            print(line, file=sys.stderr, flush=True)


def lines(percent: float, status: str) -> list[str]:
    """Return lines that farms understand: Open Job Description's, or ``Progress: 12%`` for Deadline and others."""
    if OPENJD in os.environ:
        return [f"openjd_progress: {percent:.1f}", f"openjd_status: {status}"]
    return [f"Progress: {int(percent)}% {status}"]
