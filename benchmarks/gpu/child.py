"""Runs a step in its own process: if it crashes, hangs or takes too long, the other steps still run."""

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

ROOT = Path(__file__).parents[2]  # of the checkout that contains the tests
GRACE = 10.0  # seconds for writing results after a process is told to stop
DYING = 2.0  # seconds to end after a process is killed
POLL = 0.2  # seconds between two checks of the process


@dataclass(frozen=True)
class Ended:
    """How a process ended.

    Parameters
    ----------
    code : int, optional
        Its exit code, below 0 for a signal; None if it was stopped at its time limit.
    seconds : float
    output, errors : str
        Its output on stdout and stderr.
    """

    code: int | None
    seconds: float
    output: str
    errors: str

    @property
    def is_short(self) -> bool:
        """Whether it was stopped at its time limit."""
        return self.code is None


def run(
    command: Sequence[str],
    seconds: float,
    logs: tuple[Path, Path],
    environment: Mapping[str, str],
    tick: Callable[[float], None],
) -> Ended:
    """Run ``python -m`` with a command and a time limit.

    Parameters
    ----------
    command : sequence of str
        A module and its arguments.
    seconds : float
        The time limit. The process is interrupted as by Ctrl-C; after `GRACE` more seconds it is killed with all its
        children.
    logs : pair of Path
        Files for its stdout and stderr.
    environment : mapping of str to str
    tick : callable
        Called from time to time with the seconds that have passed.
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
            start_new_session=True,  # so that its children can be ended with it
            preexec_fn=listen,
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


def listen() -> None:
    """Let SIGINT interrupt this process even if its parent ignores it, as a shell's background job does."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def end(process: subprocess.Popen[bytes]) -> None:
    """End a process and its children; a process that hangs in a driver inside the kernel is left behind."""
    if process.poll() is None:
        os.killpg(process.pid, signal.SIGINT)  # to the whole group, as a terminal does
        with contextlib.suppress(subprocess.TimeoutExpired):
            process.wait(GRACE)
    with contextlib.suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
    with contextlib.suppress(subprocess.TimeoutExpired):
        process.wait(DYING)
