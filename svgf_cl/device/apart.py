"""Asks a question of a driver in a process of its own, which it may crash or hang."""

from __future__ import annotations

import json
import signal
import subprocess
from collections.abc import Mapping, Sequence

TIMEOUT_SECONDS = 60

# Starts the line that holds the answer, as drivers print on their own account, at exit too.
ANSWER = "svgf_cl is answered "


class NoAnswerError(Exception):
    """The question came to no end; the message says how."""


def ask(command: Sequence[str], environment: Mapping[str, str]) -> str:
    """Run a command that prints the line that `answer` makes, and return the answer.

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
        Where the process cannot be started, crashes, hangs or ends without an answer.
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
    """Return the line that `ask` finds the answer in."""
    return ANSWER + json.dumps(text)


def summary(log: str) -> str:
    """Return the line of a driver's message that says most: the first that names an error, else the last.

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
