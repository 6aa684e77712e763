"""A step's process: it may crash, hang or take too long, and the run goes on."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[2]  # of the checkout, where tests are found
GRACE = 10.0  # seconds to write what is known, once a process is told to stop
DYING = 2.0  # seconds to end, once it is killed
POLL = 0.2  # seconds between two looks at it


@dataclass(frozen=True)
class Ended:
    """How a process ended.

    Parameters
    ----------
    code : int, optional
        Its exit code, a signal's number below 0; None if it was stopped at its limit.
    seconds : float
    output, errors : str
        What it wrote to stdout and stderr.
    """

    code: int | None
    seconds: float
    output: str
    errors: str

    @property
    def is_short(self) -> bool:
        """Whether it was stopped at its limit."""
        return self.code is None


def run(
    command: Sequence[str],
    seconds: float,
    logs: tuple[Path, Path],
    environment: Mapping[str, str],
    tick: Callable[[float], None],
) -> Ended:
    """Run ``python -m`` with a command, for so many seconds at most.

    Parameters
    ----------
    command : sequence of str
        A module and its arguments.
    seconds : float
        When it is told to stop, as Ctrl-C does; after `GRACE` more it is killed with all that it started.
    logs : pair of Path
        Files that get its stdout and stderr.
    environment : mapping of str to str
    tick : callable
        Is told now and then how many seconds have passed.
    """
    begin = time.monotonic()
    with logs[0].open("w") as output, logs[1].open("w") as errors:
        process = subprocess.Popen(
            [sys.executable, "-m", *command],
            env=environment,
            cwd=ROOT,
            stdin=subprocess.DEVNULL,
            stdout=output,
            stderr=errors,
            start_new_session=True,  # so that all that it starts can be ended with it
        )
        try:
            while process.poll() is None and time.monotonic() - begin < seconds:
                tick(time.monotonic() - begin)
                time.sleep(POLL)
            code = process.poll()
        finally:
            end(process)
    said = [log.read_text(errors="replace") for log in logs]
    return Ended(code, time.monotonic() - begin, *said)


def end(process: subprocess.Popen[bytes]) -> None:
    """End a process and what it has started; one that a driver holds in the kernel is left behind."""
    if process.poll() is None:
        os.killpg(process.pid, signal.SIGINT)  # all of it, as a terminal does
        with contextlib.suppress(subprocess.TimeoutExpired):
            process.wait(GRACE)
    with contextlib.suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
    with contextlib.suppress(subprocess.TimeoutExpired):
        process.wait(DYING)
