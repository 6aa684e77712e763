"""What the tests of the denoiser do without."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]


def test_kernels_and_denoiser_are_tested_without_the_tracer() -> None:
    """Neither Numba nor Embree has to be there, nor is anything of the tracer imported."""
    without = ("-p", "tests.without_tracer", "--collect-only", "-q")
    tests = ("tests/kernels", "tests/hard", "tests/fuzz", "tests/svgf_cl", "tests/examples")
    command = [sys.executable, "-m", "pytest", *without, *tests]
    collected = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert collected.returncode == 0, collected.stdout
    assert "error" not in collected.stdout.splitlines()[-1]
