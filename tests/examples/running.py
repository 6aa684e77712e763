"""Runs an example as whoever copies it does."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

from PIL import Image

EXAMPLES = Path(__file__).parents[2] / "examples"


def assert_gains(name: str, decibels: float, folder: Path) -> None:
    """Run an example: it gains so many decibels, says nothing but that, and writes one picture of both."""
    command = [sys.executable, str(EXAMPLES / f"{name}.py"), str(folder)]
    ran = subprocess.run(command, cwd=EXAMPLES.parent, capture_output=True, text=True, timeout=300, check=False)
    assert ran.returncode == 0, ran.stderr
    noisy, denoised = map(float, re.findall(r"(\S+) dB", ran.stdout))
    assert denoised > noisy + decibels, ran.stdout
    (picture,) = folder.iterdir()
    assert picture.name == f"{name}.png"
    with Image.open(picture) as opened:
        low, high = opened.convert("L").getextrema()
    assert low < 64
    assert high > 192
