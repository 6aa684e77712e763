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
from benchmarks.suites import suite

OPTIONS = ("-n", "auto", "--maxprocesses", "8", "--durations", "12", "--durations-min", "5")


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
            if not ends_well("pytest", *OPTIONS, *chosen, environment=environment):
                failed.append(name)
    if not brief:
        print("\ntest-all: accuracy", flush=True)
        if not ends_well("benchmarks.accuracy_page"):
            failed.append("accuracy")
    sys.exit(f"test-all: failed: {', '.join(failed)}" if failed else 0)


if __name__ == "__main__":
    main()
