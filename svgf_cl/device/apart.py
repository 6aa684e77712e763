"""Asks a driver a question in a separate process, as the driver may crash or hang."""

from __future__ import annotations

import json
import signal
import subprocess
from collections.abc import Mapping, Sequence

TIMEOUT_SECONDS = 60

# The answer's line starts with this, because drivers print lines of their own, even at exit.
ANSWER = "svgf_cl is answered "


class NoAnswerError(Exception):
    """The process gave no answer; the message says why."""


def ask(command: Sequence[str], environment: Mapping[str, str]) -> str:
    """Run a command that prints the line made by `answer`, and return the answer.

    Parameters
    ----------
    command : sequence of str
    environment : mapping of str to str
        All environment variables of the process.

    Returns
    -------
    str

    Raises
    ------
    NoAnswerError
        If the process cannot be started, crashes, hangs or ends without an answer.
    """
    try:
        child = subprocess.run(
            command, env=environment, capture_output=True, text=True, errors="replace", timeout=TIMEOUT_SECONDS
        )
    except subprocess.TimeoutExpired as hang:
        raise NoAnswerError(f"the driver hangs: no answer within {TIMEOUT_SECONDS} s") from hang
    except OSError as error:
        raise NoAnswerError(f"the probe cannot be started: {error}") from error
    if child.returncode < 0:
        crash = signal.Signals(-child.returncode).name
        raise NoAnswerError(f"the driver crashes ({crash}): {summary(child.stderr)}")
    answers = [line.removeprefix(ANSWER) for line in child.stdout.splitlines() if line.startswith(ANSWER)]
    if child.returncode or not answers:
        raise NoAnswerError(f"the probe fails: {summary(child.stderr)}")
    return str(json.loads(answers[-1]))


def answer(text: str) -> str:
    """Return the line in which `ask` finds the answer."""
    return ANSWER + json.dumps(text)


def summary(log: str) -> str:
    """Return the most useful line of a driver's message: the first that contains "error", else the last.

    Parameters
    ----------
    log : str
        May be empty.

    Returns
    -------
    str
    """
    lines = [line.strip() for line in log.splitlines() if line.strip()]
    errors = (line for line in lines if "error" in line.lower())
    return next(errors, lines[-1] if lines else "the driver gives no reason")
