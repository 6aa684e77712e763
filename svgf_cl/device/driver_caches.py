"""Turns off the caches of pyopencl and PoCL where their folders cannot be written: they would fail, or wait."""

from __future__ import annotations

import contextlib
import os
from pathlib import Path

import pyopencl as cl

from svgf_cl.io.cache import is_usable, temporary_folder, users_folder

POCL_VARIABLE = "POCL_CACHE_DIR"


def do_without() -> None:
    """Turn off pyopencl's cache, and give PoCL a temporary one, if theirs cannot be written.

    PoCL's temporary cache lasts as long as this process. Call this before the first listing of platforms in this
    process, as PoCL reads its variable only once.
    """
    # pyopencl raises an error if it cannot make the folder. If it cannot make a file, it waits a minute for a lock.
    if not cl._PYOPENCL_NO_CACHE and not all(is_usable(users_folder(name)) for name in ("pyopencl", "pytools")):
        cl._PYOPENCL_NO_CACHE = True
    # PoCL compiles through files in its cache, and lists no device if it cannot write them.
    if not is_usable(Path(os.environ.get(POCL_VARIABLE) or users_folder("pocl"))):
        with contextlib.suppress(OSError):
            os.environ[POCL_VARIABLE] = str(temporary_folder() / "pocl")
