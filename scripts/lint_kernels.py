"""Checks every kernel with clang, for each combination of the macros that it reads, and how kernels are written with
clang-format; needs no OpenCL device.
"""

from __future__ import annotations

import itertools
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from svgf_cl.device import programs

MACROS = {
    "VW": (1, 4, 8, 16),
    "SIGNALS": (1, 2),
    "MOTION": (2, 3),
    "HAS_ALBEDO": (0, 1),
    "HAS_EMISSION": (0, 1),
    "HAS_ID": (0, 1),
    "TAA": (0, 1),
}
# These say how something is done, not what there is: one value against another, and all at once, will do.
VARIANTS = (
    {"FAST": 0, "RADIUS": 2, "HALF_GUIDES": 0, "HALF_HISTORY": 0},
    {"FAST": 1, "RADIUS": 2, "HALF_GUIDES": 0, "HALF_HISTORY": 1},
    {"FAST": 0, "RADIUS": 1, "HALF_GUIDES": 1, "HALF_HISTORY": 0},
    {"FAST": 1, "RADIUS": 1, "HALF_GUIDES": 1, "HALF_HISTORY": 1},
)
# -Wundef: a macro that a kernel reads and this table lacks is an error, never a silent 0.
LANGUAGE = ("-x", "cl", "-cl-std=CL1.2", "-target", "spir64", "-Xclang", "-finclude-default-header")
WARNINGS = (
    *("-Wall", "-Wextra", "-Wconversion", "-Wundef", "-Wshadow", "-Wcast-qual", "-Wdouble-promotion"),
    *("-Wunreachable-code", "-Wextra-semi-stmt", "-Werror"),
)

ROOT = Path(__file__).resolve().parent.parent
FORMATTED = ("kernels/*.cl", "kernels/*.clh", "svgf_cl/bench/*.cl")


def combinations(source: str) -> Iterator[dict[str, int]]:
    """Every variant with all values of the macros that a source reads, comments aside; others cannot change it."""
    code = re.sub(r"//.*", "", source)
    names = [name for name in MACROS if re.search(rf"\b{name}\b", code)]
    for variant, values in itertools.product(VARIANTS, itertools.product(*(MACROS[name] for name in names))):
        yield dict(zip(names, values, strict=True)) | variant


def check(stage: str, macros: dict[str, int]) -> str:
    """Clang's complaints about a stage, empty if there are none."""
    defines = [f"-D{name}={value}" for name, value in macros.items()]
    command = ["clang", "-fsyntax-only", *LANGUAGE, *WARNINGS, *defines, "-"]
    clang = subprocess.run(command, input=programs.source(stage), text=True, capture_output=True)
    return f"kernels/{stage}.cl with {' '.join(defines)}:\n{clang.stderr}" if clang.returncode else ""


def unformatted() -> str:
    """Clang-format's complaints, empty if there are none."""
    # That beside this Python is of the version that pyproject.toml asks for; each lays things out in a way of its own.
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
    jobs = [(stage, macros) for stage in programs.stages() for macros in combinations(programs.source(stage))]
    with ThreadPoolExecutor() as pool:
        complaints = list(filter(None, pool.map(lambda job: check(*job), jobs)))
    layout = unformatted()
    print(*complaints[:3], layout, f"{len(jobs)} kernel variants checked, {len(complaints)} with errors", sep="\n")
    return 1 if complaints or layout else 0


if __name__ == "__main__":
    sys.exit(main())
