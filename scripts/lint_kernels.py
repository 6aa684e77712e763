"""Checks all kernels with clang, for all fields that frames may have, and their format with clang-format.

It needs no OpenCL device.
"""

from __future__ import annotations

import itertools
import random
import shutil
import subprocess
import sys
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

from benchmarks.builds import Build, Case, builds
from svgf_cl.device import programs
from svgf_cl.device.tuning import EXPONENTIALS, VECTOR_WIDTHS, Tuning
from svgf_cl.filters import FILTERS
from svgf_cl.filters.filter import Filter
from svgf_cl.filters.signals import SPLITS, Inputs
from svgf_cl.settings import domains

TUNINGS = [
    Tuning(vector_width=width, work_group=(1, 1), exponential=exponential)
    for exponential in EXPONENTIALS
    for width in VECTOR_WIDTHS
]
# These settings and the tuning change how something is done, not what is there. Each value is tried, but not every
# combination.
SETTINGS: tuple[dict[str, Any], ...] = (
    {"precision": "precise", "taps": "5x5", "standard_error": True},
    {"precision": "fast", "taps": "5x5", "half_history": True},
    {"precision": "precise", "taps": "3x3", "half_guides": True},
    {"precision": "fast", "taps": "3x3", "half_guides": True, "half_history": True},
)
# -Wundef: a macro that a kernel uses and that no filter defines is an error, not a silent 0.
LANGUAGE = ("-x", "cl", "-cl-std=CL1.2", "-target", "spir64", "-Xclang", "-finclude-default-header")
WARNINGS = (
    *("-Wall", "-Wextra", "-Wconversion", "-Wundef", "-Wshadow", "-Wcast-qual", "-Wdouble-promotion"),
    *("-Wunreachable-code", "-Wextra-semi-stmt", "-Werror"),
)

EITHER = (False, True)
ROOT = Path(__file__).resolve().parent.parent
FORMATTED = ("kernels/*.cl", "kernels/*.clh", "svgf_cl/bench/*.cl", "examples/*.cl", "examples/c_host/*.[ch]")


def inputs() -> Iterator[Inputs]:
    """All combinations of fields that frames may have."""
    for signals, motion, albedo, emission, id_ in itertools.product(SPLITS, (2, 3), EITHER, EITHER, EITHER):
        yield Inputs(signals=signals, motion=motion, albedo=albedo, emission=emission, id=id_)


def variants() -> list[Build]:
    """All builds that do not depend on a filter, and the builds of each filter for all combinations of fields.

    Settings and tunings of these builds are chosen at random, with a fixed seed: the product of all would take minutes,
    and find no more.
    """
    draw = random.Random(0)
    return builds(
        Case(variant(kind, draw.choice(SETTINGS) | {"taa": draw.choice(EITHER)}), supplied, draw.choice(TUNINGS))
        for kind, supplied in itertools.product(FILTERS.values(), inputs())
    )


def variant(kind: type[Filter], wanted: dict[str, Any]) -> Filter:
    """A filter with those of the wanted settings that it has."""
    return kind(**{name: value for name, value in wanted.items() if name in domains(kind)})


def check(build: Build) -> str:
    """The messages of clang about a source, empty if there are none."""
    command = ["clang", "-fsyntax-only", *LANGUAGE, *WARNINGS, *build.macros, "-"]
    clang = subprocess.run(command, input=programs.source(build.source), text=True, capture_output=True)
    return f"kernels/{build.source}.cl with {' '.join(build.macros)}:\n{clang.stderr}" if clang.returncode else ""


def unformatted() -> str:
    """The messages of clang-format, empty if there are none."""
    # Use the clang-format of this Python, which has the version of pyproject.toml; other versions format differently.
    clang_format = shutil.which("clang-format", path=str(Path(sys.executable).parent))
    if clang_format is None:
        return "clang-format is missing beside this Python; install the project's dev extra"
    files = [str(file) for pattern in FORMATTED for file in sorted(ROOT.glob(pattern))]
    command = [clang_format, "--dry-run", "-Werror", *files]
    return subprocess.run(command, text=True, capture_output=True).stderr


def main() -> int:
    if shutil.which("clang") is None:
        print("lint_kernels: clang is missing; install it, e.g. apt-get install clang", file=sys.stderr)
        return 1
    checked = variants()
    with ThreadPoolExecutor() as pool:
        complaints = list(filter(None, pool.map(check, checked)))
    layout = unformatted()
    print(*complaints[:3], layout, f"{len(checked)} kernel variants checked, {len(complaints)} with errors", sep="\n")
    return 1 if complaints or layout else 0


if __name__ == "__main__":
    sys.exit(main())
