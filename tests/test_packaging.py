"""What is installed is what is needed: the wheel works outside the checkout, with kernels and types."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

from svgf_cl.view.server import FILES

ROOT = Path(__file__).parents[1]

USE = """
import sys, svgf_cl, svgf_cl_tracer
from svgf_cl.cli import commands
from svgf_cl.device import devices
from svgf_cl.device import programs
for package in (svgf_cl, svgf_cl_tracer):
    assert package.__file__.startswith(sys.argv[1]), package.__file__
assert commands()["render"].__module__ == "svgf_cl_tracer.cli.render"
queue = devices.default_queue()
macros = {"VW": 4, **svgf_cl.Settings().pipeline(svgf_cl.Inputs()).defines}
print(programs.build(queue.context, queue.device, "variance", macros).kernel_names)
"""


@pytest.fixture(scope="module")
def wheel(tmp_path_factory) -> Path:
    """The wheel, built from a copy so that the checkout stays clean."""
    copy = tmp_path_factory.mktemp("source")
    for name in ("svgf_cl", "kernels", "tracer"):
        shutil.copytree(ROOT / name, copy / name)
    for name in ("setup.py", "pyproject.toml", "LICENSE", "README.md"):
        shutil.copy(ROOT / name, copy)
    build = [
        sys.executable,
        "-m",
        "pip",
        "wheel",
        "--quiet",
        "--no-deps",
        "--no-build-isolation",
        "--wheel-dir=dist",
        ".",
    ]
    subprocess.run(build, cwd=copy, check=True)
    (built,) = (copy / "dist").glob("*.whl")
    return built


def test_wheel_holds_kernels_types_pages_and_license(wheel):
    names = set(zipfile.ZipFile(wheel).namelist())
    assert {f"svgf_cl/kernels/{path.name}" for path in (ROOT / "kernels").glob("*.cl*")} <= names
    assert {"svgf_cl/py.typed", "svgf_cl/denoiser.py", "svgf_cl/export/plan.schema.json"} <= names
    assert {f"svgf_cl/compare/page.{kind}" for kind in ("html", "css", "js")} <= names
    assert {f"{package.replace('.', '/')}/{name}" for package, name, _ in FILES.values()} <= names
    assert "svgf_cl_tracer/builtin/cornell.py" in names
    (declared,) = (name for name in names if name.endswith("entry_points.txt"))
    assert "svgf_cl_tracer.cli.render:render" in zipfile.ZipFile(wheel).read(declared).decode()
    assert any(name.endswith("LICENSE") for name in names)
    assert not any(name.startswith(("tests", "kernels", "benchmarks", "tracer/")) for name in names)


def test_installed_wheel_builds_a_program_anywhere(wheel, tmp_path):
    site = tmp_path / "site"
    install = [
        sys.executable,
        "-m",
        "pip",
        "install",
        "--quiet",
        "--no-deps",
        "--no-compile",
        f"--target={site}",
        wheel,
    ]
    subprocess.run(install, check=True)
    used = subprocess.run(
        [sys.executable, "-c", USE, site],
        cwd=tmp_path,
        env=os.environ | {"PYTHONPATH": str(site)},
        capture_output=True,
        text=True,
    )
    assert used.returncode == 0, used.stderr
    assert used.stdout.strip() == "variance"
