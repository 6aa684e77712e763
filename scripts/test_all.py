"""Runs the tests on every OpenCL implementation, then compares every kernel with the oracle on all of them.

This is `make test-all`; each implementation has its own process. With ``--brief``, as in CI, all tests run on PoCL and
only the tests of kernels on other implementations. Nothing is measured then, because the tests check the tolerance of
every error.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

from benchmarks.implementations import Environment, environments
from benchmarks.suites import PARALLEL, suite

OPTIONS = (*PARALLEL, "--durations", "12", "--durations-min", "5")


def ends_well(*module: str, environment: Environment | None = None) -> bool:
    """Run a Python module with these arguments, and return whether it succeeded."""
    return subprocess.run([sys.executable, "-m", *module], env=environment).returncode == 0


def main() -> None:
    """Run everything, or the brief choice; the exit code is 1 if something failed."""
    brief = sys.argv[1:] == ["--brief"]
    failed = []
    with tempfile.TemporaryDirectory() as folder:
        for name, environment in environments(Path(folder)).items():
            print(f"\ntest-all: {name}", flush=True)
            chosen = suite(name, brief=brief)
            if not ends_well("pytest", *OPTIONS, *chosen, environment=environment):
                failed.append(name)
    if not brief:
        print("\ntest-all: accuracy", flush=True)
        if not ends_well("benchmarks.accuracy_page"):
            failed.append("accuracy")
    sys.exit(f"test-all: failed: {', '.join(failed)}" if failed else 0)


if __name__ == "__main__":
    main()
