"""The example for Blender switches on what is read, and runs where bpy is installed."""

from __future__ import annotations

import re
import runpy
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path
from typing import Any
from unittest.mock import MagicMock

import numpy as np
import pytest

from svgf_cl.io.display import display
from svgf_cl.io.pictures import read_picture
from svgf_cl.io.readers.blender import BLENDER
from tests.examples.running import EXAMPLES

EXAMPLE = EXAMPLES / "blender.py"
FRAMES = 4


@pytest.fixture
def example(monkeypatch: pytest.MonkeyPatch) -> dict[str, Any]:
    """What the example defines; it needs no Blender for that."""
    monkeypatch.setitem(sys.modules, "bpy", MagicMock())
    return runpy.run_path(str(EXAMPLE), run_name="example")


def test_its_passes_are_those_that_the_reader_asks_for(example: dict[str, Any]) -> None:
    asked = {found[1] for text in BLENDER.switches.values() if (found := re.search(r"Passes > Data > ([\w ]+)", text))}
    assert len(asked) == 4
    assert asked <= example["DATA_PASSES"].keys()


def test_its_light_passes_are_all_that_the_reader_adds_up(example: dict[str, Any]) -> None:
    names = {name for light in BLENDER.lights for name in (*light.names, light.factor) if name}
    spelled_out = {name for name in names if " " in name} | {"Environment"}
    switches = {f"use_pass_{name.lower().replace(' ', '_')}" for name in spelled_out} | {"use_pass_emit"}
    assert {name.rpartition(".")[2] for name in example["LIGHT_PASSES"]} == switches


@pytest.mark.skipif(find_spec("bpy") is None, reason="bpy is not installed: pip install bpy")
def test_it_renders_and_denoises(tmp_path: Path) -> None:
    options = ["--frames", str(FRAMES), "--samples", "1", "--svgf-cl", f"{sys.executable} -m svgf_cl"]
    command = [sys.executable, str(EXAMPLE), str(tmp_path), *options]
    ran = subprocess.run(command, cwd=EXAMPLES.parent, capture_output=True, text=True, timeout=600, check=False)
    assert ran.returncode == 0, ran.stderr
    assert "light passes: " in ran.stdout
    assert f"denoised ones and PNGs to look at in {tmp_path / 'denoised'}" in ran.stdout
    noisy, denoised = (sorted((tmp_path / name).glob("*.exr")) for name in ("noisy", "denoised"))
    assert [path.name for path in noisy] == [path.name for path in denoised]
    assert len(list((tmp_path / "denoised").glob("*.png"))) == len(noisy) == FRAMES
    assert roughness(denoised[-1]) < 0.7 * roughness(noisy[-1])


def roughness(path: Path) -> float:
    """How much a picture as shown differs from pixel to pixel."""
    shown = display(read_picture(path))
    return float(np.abs(np.diff(shown, axis=0)).mean() + np.abs(np.diff(shown, axis=1)).mean())
