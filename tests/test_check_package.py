"""The check of packages finds what is missing; `make package` runs it on the packages themselves."""

from __future__ import annotations

import tarfile
import zipfile
from pathlib import Path

import pytest

from scripts.check_package import check_source, check_wheel

NAMES = {".gitignore", "README.md", "kernels/atrous.cl", "svgf_cl/__init__.py", "tracer/svgf_cl_tracer/api.py"}
WHEEL = ("svgf_cl/__init__.py", "svgf_cl/kernels/atrous.cl", "svgf_cl_tracer/api.py")


def archive(folder: Path, *names: str) -> Path:
    """A source archive with these files."""
    (folder / "file").touch()
    with tarfile.open(folder / "source.tar.gz", "w:gz") as opened:
        for name in ("PKG-INFO", "svgf_cl.egg-info/SOURCES.txt", *names):
            opened.add(folder / "file", f"svgf_cl-1/{name}")
    return folder / "source.tar.gz"


def wheel(folder: Path, *names: str, description: str = "[a](https://example.org)") -> Path:
    """A wheel with these files."""
    with zipfile.ZipFile(folder / "some.whl", "w") as opened:
        for name in names:
            opened.writestr(name, "")
        opened.writestr("svgf_cl-1.dist-info/METADATA", f"Name: svgf_cl\n\n{description}")
    return folder / "some.whl"


def test_whole_packages_pass(tmp_path: Path) -> None:
    check_source(archive(tmp_path, *(NAMES - {".gitignore"})), NAMES)
    check_wheel(wheel(tmp_path, *WHEEL), NAMES)


def test_a_file_that_is_missing_or_left_over_is_named(tmp_path: Path) -> None:
    with pytest.raises(SystemExit, match=r"lacks \['kernels/atrous\.cl'\] and has \['build\.log'\]"):
        check_source(archive(tmp_path, *(NAMES - {".gitignore", "kernels/atrous.cl"}), "build.log"), NAMES)
    with pytest.raises(SystemExit, match=r"lacks \['svgf_cl/kernels/atrous\.cl'\]"):
        check_wheel(wheel(tmp_path, WHEEL[0], WHEEL[2]), NAMES)


def test_a_link_that_leads_nowhere_on_an_index_is_named(tmp_path: Path) -> None:
    with pytest.raises(SystemExit, match=r"docs/gpu\.md"):
        check_wheel(wheel(tmp_path, *WHEEL, description="[a](docs/gpu.md)"), NAMES)
