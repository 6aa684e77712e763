"""Runs an example as whoever copies it does, but in this process, with the vectors that are compiled already."""

from __future__ import annotations

import contextlib
import io
import re
import runpy
import sys
from pathlib import Path

import pytest
from PIL import Image

EXAMPLES = Path(__file__).parents[2] / "examples"


def assert_gains(name: str, decibels: float, folder: Path) -> None:
    """Run an example: it gains so many decibels, says nothing but that, and writes one picture of both."""
    example = str(EXAMPLES / f"{name}.py")
    with pytest.MonkeyPatch.context() as patch, contextlib.redirect_stdout(io.StringIO()) as said:
        patch.setattr(sys, "argv", [example, str(folder)])
        runpy.run_path(example, run_name="__main__")
    noisy, denoised = map(float, re.findall(r"(\S+) dB", said.getvalue()))
    assert denoised > noisy + decibels, said.getvalue()
    (picture,) = folder.iterdir()
    assert picture.name == f"{name}.png"
    with Image.open(picture) as opened:
        low, high = opened.convert("L").getextrema()
    assert low < 64
    assert high > 192
