"""Progress where it goes to a file or a farm: a line now and then."""

from __future__ import annotations

import os
import sys
from datetime import timedelta
from time import monotonic

SECONDS = 10.0  # between two lines
OPENJD = "OPENJD_SESSION_WORKING_DIR"  # a variable that processes have which run under Open Job Description


class Log:
    """Progress as lines on stderr: at most one in `SECONDS`, none of what takes less.

    Parameters
    ----------
    title : str
        What is done.
    total : int
        How much there is to do.
    resumed : bool
        Whether what is done at the first report was done before: the time left is judged by what follows.
    """

    def __init__(self, title: str, total: int, *, resumed: bool = False) -> None:
        self._title, self._total = title, total
        self._began = self._last = monotonic()
        self._start = None if resumed else 0.0

    def report(self, done: float, remark: str = "") -> None:
        """So much is done; write a line where it is time for one."""
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
    """What a farm reads of a log: Open Job Description its own lines, others such as Deadline ``Progress: 12%``."""
    if OPENJD in os.environ:
        return [f"openjd_progress: {percent:.1f}", f"openjd_status: {status}"]
    return [f"Progress: {int(percent)}% {status}"]
