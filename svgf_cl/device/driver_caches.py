"""What pyopencl and drivers keep on their own account, where they cannot: they would fail, or wait for ever."""

from __future__ import annotations

import contextlib
import os
from pathlib import Path

import pyopencl as cl

from svgf_cl.io.cache import is_usable, temporary_folder, users_folder

POCL_VARIABLE = "POCL_CACHE_DIR"


def do_without() -> None:
    """Have pyopencl use no cache, and PoCL one that lasts as long as this process, where theirs cannot be written.

    Takes effect only before the first listing of platforms in this process, as PoCL looks once.
    """
    # It raises an error where it cannot make the folder, and waits a minute for a lock where it cannot make a file.
    if not cl._PYOPENCL_NO_CACHE and not all(is_usable(users_folder(name)) for name in ("pyopencl", "pytools")):
        cl._PYOPENCL_NO_CACHE = True
    # It compiles by way of files there, and lists no device where it cannot.
    if not is_usable(Path(os.environ.get(POCL_VARIABLE) or users_folder("pocl"))):
        with contextlib.suppress(OSError):
            os.environ[POCL_VARIABLE] = str(temporary_folder() / "pocl")
