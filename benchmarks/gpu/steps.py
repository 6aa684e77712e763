"""The steps of a run. Each is a command of the project that runs in its own process, with a time limit."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from benchmarks.accuracy_page import BRIEF, HERE
from benchmarks.gpu import child, findings
from benchmarks.gpu.child import Ended
from benchmarks.gpu.findings import Found
from benchmarks.suites import KERNELS, ON_A_DEVICE, PARALLEL
from svgf_cl.device.apart import summary

LONGEST = 600  # seconds for the whole run

# Tests that are not in KERNELS: hard inputs, sizes, thousands of frames.
HARD = tuple(name for name in ON_A_DEVICE if name not in KERNELS)
PYTEST = ("pytest", *PARALLEL, "-q", "-p", "no:cacheprovider")

SVGF = r"svgf\.(demodulate|temporal|variance|atrous|modulate|frame|enqueue)"


@dataclass(frozen=True)
class Step:
    """A step of a run.

    Parameters
    ----------
    name : str
        The name of its files.
    title : str
    command : tuple of str
        A module and its arguments.
    seconds : int
        Its time limit.
    result : Path
        The file that it writes.
    read : callable
        Makes tables from that file; errors of reading a wrong file are reported.
    """

    name: str
    title: str
    command: tuple[str, ...]
    seconds: int
    result: Path
    read: Callable[[Path, Ended], Found]

    def found(self, ended: Ended) -> Found:
        """The result; if it cannot be read, the reason."""
        try:
            return self.read(self.result, ended)
        except (ValueError, LookupError, TypeError, OSError, SyntaxError) as error:  # SyntaxError is from ElementTree
            return Found(complaint=complaint(self, ended, error))


def complaint(step: Step, ended: Ended, error: Exception) -> str:
    """The reason why a step has no result."""
    if ended.is_short:
        return f"no result within {step.seconds} s; it was stopped"
    said = summary(ended.errors or ended.output)
    return f"exit code {ended.code}: {said}" if ended.code else f"its result cannot be read ({error})"


def full(folder: Path) -> list[Step]:
    """All steps, for a GPU."""
    sizes = ("--size", "1280x720", "--size", "1920x1080")
    return [
        tests("kernels", "every kernel against the oracle", KERNELS, folder, 140),
        tune(folder, ("--size", "1920x1080", "--seconds", "30"), 75),
        bench("bench", ("--seconds", "0.5"), folder, 130),
        bench("bench_svgf", (*sizes, "--filter", "svgf", "--only", SVGF, "--no-ceilings"), folder, 40),
        accuracy(folder, (), 65),
        tests("hard", "hard cases against the oracle", HARD, folder, 75),
    ]


def dry(folder: Path) -> list[Step]:
    """The same steps with small sizes: for a CPU in CI."""
    size, sizes = "64x36", ("--size", "64x36")
    brief = ("--seconds", "0", *sizes, "--only", rf"\.{size}$")
    return [
        tests(
            "kernels",
            "some kernels against the oracle",
            ("tests/kernels/test_oracle.py", "-k", "plain]"),
            folder,
            120,
        ),
        tune(folder, (*sizes, "--seconds", "4", "--no-store"), 60),
        bench("bench", brief, folder, 120),
        bench("bench_svgf", (*brief, "--filter", "svgf", "--no-ceilings"), folder, 60),
        accuracy(folder, (BRIEF,), 120),
        tests(
            "hard",
            "a hard case against the oracle",
            ("tests/hard/test_sizes.py::test_follows_the_oracle[Kalman-(2, 3)]",),
            folder,
            120,
        ),
    ]


def tests(name: str, title: str, chosen: tuple[str, ...], folder: Path, seconds: int) -> Step:
    """A step that compares kernels with the oracle by tests."""
    result = folder / f"{name}.xml"
    return Step(name, title, (*PYTEST, f"--junitxml={result}", *chosen), seconds, result, findings.tests)


def tune(folder: Path, options: tuple[str, ...], seconds: int) -> Step:
    """A step that searches for the fastest tuning and stores it for later runs."""
    result = folder / "tune.json"
    command = ("svgf_cl", "tune", *options, "--json", str(result))
    return Step("tune", "the fastest tuning", command, seconds, result, findings.tune)


def bench(name: str, options: tuple[str, ...], folder: Path, seconds: int) -> Step:
    """A step that benchmarks one filter."""
    command = ("svgf_cl", "bench", "-o", str(folder / name), *options)
    filter_ = "SVGF" if "svgf" in options else "the default filter"
    return Step(name, f"times of {filter_}", command, seconds, folder / name / "results.json", findings.bench)


def accuracy(folder: Path, options: tuple[str, ...], seconds: int) -> Step:
    """A step that measures the largest error of each kernel."""
    command = ("benchmarks.accuracy_page", HERE, *options)
    return Step("accuracy", "each kernel's error", command, seconds, logs(folder, "accuracy")[0], findings.accuracy)


def logs(folder: Path, name: str) -> tuple[Path, Path]:
    """The files for a step's stdout and stderr."""
    return folder / f"{name}.out.txt", folder / f"{name}.err.txt"


def run(step: Step, folder: Path, environment: dict[str, str], tick: Callable[[float], None]) -> tuple[Ended, Found]:
    """Run a step and read its result; results of an earlier run are deleted first."""
    step.result.unlink(missing_ok=True)
    ended = child.run(step.command, step.seconds, logs(folder, step.name), environment, tick)
    return ended, step.found(ended)
