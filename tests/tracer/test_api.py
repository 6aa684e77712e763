"""What `import svgf_cl_tracer` offers, though it imports nothing."""

from __future__ import annotations

import subprocess
import sys

import pytest

import svgf_cl_tracer
from svgf_cl_tracer import api

LOOK = """
import sys, svgf_cl_tracer
assert "numba" not in sys.modules
assert svgf_cl_tracer.Shot.__module__ == "svgf_cl_tracer.shot"
assert "numba" in sys.modules
"""


def test_every_public_name_is_found() -> None:
    assert all(getattr(svgf_cl_tracer, name) is getattr(api, name) for name in api.__all__)


def test_no_other_name_is_found() -> None:
    for name in ("nothing", "_private", "SvgfError"):
        with pytest.raises(AttributeError, match=f"'svgf_cl_tracer' has no attribute '{name}'"):
            getattr(svgf_cl_tracer, name)


def test_a_name_is_imported_when_it_is_asked_for() -> None:
    subprocess.run([sys.executable, "-c", LOOK], check=True)
