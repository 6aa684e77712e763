"""Runs the tests on every OpenCL implementation, each in a process of its own, then measures every kernel on all of
them against the oracle: `make test-all`. With ``--brief``, as in CI, all tests run on PoCL, elsewhere those of every
kernel, and nothing is measured: the tests hold every error to its tolerance.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

from benchmarks.implementations import Environment, environments

# The kernels once more, on path-traced frames.
TRACED = "tests/tracer/test_kernels_on_traced.py"
# All that touches a device; the rest is the same everywhere.
ON_A_DEVICE = (
    "tests/kernels",
    "tests/hard",
    TRACED,
    "tests/tracer/hard",
    "tests/svgf_cl/test_denoiser.py",
    *(f"tests/svgf_cl/device/test_{name}.py" for name in ("probe", "programs", "tuning")),
    "tests/svgf_cl/filters/test_stages.py",
    "tests/svgf_cl/oracle/test_accuracy.py",
)
# The kernels in all their variants.
VARIANTS = ("tests/kernels", "tests/hard/test_variants.py", "-k", "follows_the_oracle or oclgrind")
KERNELS = (TRACED, *VARIANTS)
SUITES = {
    "PoCL": ("tests",),
    # A simulator takes a millisecond and more for every pixel of a frame, and traced ones have many.
    "Oclgrind": ("-p", "tests.oclgrind", "tests/test_oclgrind.py", *VARIANTS),
}
# It has 2 GiB of memory, and takes minutes for 10 000 frames.
LEFT_OUT = {"rusticl": ("-k", "not 8k_follows and not 10000_frames")}


def suite(name: str, *, brief: bool) -> tuple[str, ...]:
    """What pytest is to run on an implementation."""
    return SUITES.get(name) or (KERNELS if brief else (*ON_A_DEVICE, *LEFT_OUT.get(name, ())))


def ends_well(*module: str, environment: Environment | None = None) -> bool:
    """Run a module of Python with these arguments."""
    return subprocess.run([sys.executable, "-m", *module], env=environment).returncode == 0


def main() -> None:
    """Run all of it, or the brief choice; exit code 1 names where it failed."""
    brief = sys.argv[1:] == ["--brief"]
    failed = []
    with tempfile.TemporaryDirectory() as folder:
        for name, environment in environments(Path(folder)).items():
            print(f"\ntest-all: {name}", flush=True)
            chosen = suite(name, brief=brief)
            if not ends_well("pytest", "-n", "auto", "--maxprocesses", "8", *chosen, environment=environment):
                failed.append(name)
    if not brief:
        print("\ntest-all: accuracy", flush=True)
        if not ends_well("benchmarks.accuracy_page"):
            failed.append("accuracy")
    sys.exit(f"test-all: failed: {', '.join(failed)}" if failed else 0)


if __name__ == "__main__":
    main()
