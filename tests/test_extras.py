"""What messages tell users to install is an extra of the package."""

from __future__ import annotations

import re
from importlib.metadata import metadata
from pathlib import Path

import svgf_cl
import svgf_cl_tracer


def test_extras_in_messages_are_those_of_the_package() -> None:
    folders = [Path(package.__file__).parent for package in (svgf_cl, svgf_cl_tracer)]
    sources = [path.read_text() for folder in folders for path in folder.rglob("*.py")]
    named = {extra for text in sources for extra in re.findall(r"""install_extra\(["']([\w-]+)["']\)""", text)}
    assert named >= {"cpu", "dask", "metrics", "tracer"}
    assert named <= set(metadata("svgf_cl").get_all("Provides-Extra"))
