"""What the tests of the denoiser do without."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
WITHOUT = ("svgf_cl_tracer", "numba", "embreex", "mapbox_earcut", "trimesh")

# As if neither the tracer nor what it is made of were installed: Python does not import what is None.
IMPORTS = f"""
import importlib, sys
sys.modules |= dict.fromkeys({WITHOUT})
for name in sys.argv[1:]:
    importlib.import_module(name)
"""


def test_kernels_and_denoiser_are_tested_without_the_tracer() -> None:
    """Neither Numba nor Embree has to be there, nor is anything of the tracer imported."""
    folders = (ROOT / "tests" / name for name in ("kernels", "hard", "fuzz", "svgf_cl", "examples"))
    paths = [path for folder in folders for path in folder.rglob("*.py")]
    modules = [".".join(path.relative_to(ROOT).with_suffix("").parts) for path in paths]
    assert len(modules) > 100
    ran = subprocess.run([sys.executable, "-c", IMPORTS, *modules], cwd=ROOT, capture_output=True, text=True)
    assert ran.returncode == 0, ran.stderr
