"""Computes the version of a process's code: machines give the same bits only with the same code and libraries."""

from __future__ import annotations

import functools
import hashlib
from collections.abc import Iterable
from importlib.metadata import version
from importlib.resources import files
from pathlib import Path

LIBRARIES = ("numpy", "OpenEXR", "pyopencl")


def code_version(sources: Iterable[tuple[str, str]], libraries: Iterable[str]) -> str:
    """Return the SHA-256, in hexadecimal digits, of named texts and of the versions of installed libraries."""
    digest = hashlib.sha256()
    for name, text in (*sources, *((library, version(library)) for library in libraries)):
        digest.update(f"{len(name)} {len(text)} {name}{text}".encode())
    return digest.hexdigest()


@functools.cache
def library_version() -> str:
    """Return the version of svgf_cl: of its sources, its kernels, and the libraries that affect its results."""
    modules = [(path.name, path.read_text(encoding="utf-8")) for path in sorted(Path(__file__).parent.rglob("*.py"))]
    entries = sorted(files("svgf_cl.kernels").iterdir(), key=lambda entry: entry.name)
    kernels = [(entry.name, entry.read_text(encoding="utf-8")) for entry in entries if ".cl" in entry.name]
    return code_version([*modules, *kernels], LIBRARIES)
