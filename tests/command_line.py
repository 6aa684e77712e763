"""Runs ``svgf-cl`` in this process, or in one that is killed."""

from __future__ import annotations

import signal
import subprocess
import sys
from pathlib import Path

import pytest

from svgf_cl.cli import main
from svgf_cl.io import cache
from tests.denoising import NARROW

# Of the frames that most tests begin with.
NAMES = [f"frame.{number:04d}.exr" for number in range(3)]

# Sends a signal to the process as the picture with that number is whole but has not got its name yet. What the tracer
# has compiled lies in the user's own cache folder, wherever the rest may be kept. Vectors are narrow, as in the parent.
KILLED = """
import os, signal, sys
from pathlib import Path
{first}
from svgf_cl.cli import main
from svgf_cl.device import tuning
from svgf_cl.io import cache
tuning.default_tuning = lambda device: tuning.{tuning!r}
left, folder, rename = int(sys.argv[1]), Path(sys.argv[2]), os.replace
def rename_or_die(source, target):
    global left
    if str(target).endswith(".exr"):
        left -= 1
        if left == -1:  # once, as several threads write
            os.kill(os.getpid(), signal.{signal})
    rename(source, target)
os.replace, cache.cache_folder = rename_or_die, lambda: folder
main(sys.argv[3:])
"""


def run(*argv: str | Path) -> int:
    """Exit code of ``svgf-cl argv``."""
    with pytest.raises(SystemExit) as left:
        main([str(argument) for argument in argv])
    return int(left.value.code or 0)


def run_killed(after: int, *argv: str | Path, first: str = "") -> None:
    """Run ``svgf-cl argv`` in a process that dies after so many EXR files; `first` is run there before all else."""
    child = run_signalled("SIGKILL", after, *argv, first=first)
    assert child.returncode == -signal.SIGKILL, child.stderr


def run_signalled(name: str, after: int, *argv: str | Path, first: str = "") -> subprocess.CompletedProcess[str]:
    """Run ``svgf-cl argv`` in a process that gets a signal after so many EXR files."""
    program = KILLED.format(first=first, signal=name, tuning=NARROW)
    command = [sys.executable, "-c", program, str(after), cache.cache_folder(), *argv]
    return subprocess.run(command, capture_output=True, text=True, check=False, timeout=300)


def contents(folder: Path) -> dict[str, bytes]:
    """What is in `folder` and those below, by name."""
    return {str(path.relative_to(folder)): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


def assert_goes_on(command: tuple[str | Path, ...], killed: tuple[int, ...], folder: Path, first: str = "") -> None:
    """A command that is killed after so many EXR files, each time it is run again, ends as if it had not been."""
    assert run(*command, "-o", folder / "whole") == 0
    whole, broken = contents(folder / "whole"), folder / "broken"
    for after in killed:
        run_killed(after, *command, "-o", broken, first=first)
        left = contents(broken)
        hidden = [name for name in left if Path(name).name.startswith(".")]
        assert 1 <= len(hidden) <= 4, "what it was writing, in two threads at most"
        assert left.items() - {(name, left[name]) for name in hidden} <= whole.items()
    done = {path: path.stat() for path in broken.rglob("[!.]*.exr")}
    assert len(done) == sum(killed)
    assert run(*command, "-o", broken) == 0
    assert contents(broken) == whole
    frames = [path for path in done if path.name.startswith("frame")]
    assert all(path.stat().st_ino == done[path].st_ino for path in frames), "kept, not written again"
