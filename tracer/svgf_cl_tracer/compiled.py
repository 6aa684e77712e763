"""Compilation of the tracer's inner loops by Numba: at their first call, and cached on disk for the next process."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import numba

from svgf_cl.io.cache import cache_folder, is_usable, tell

Function = TypeVar("Function", bound=Callable[..., object])


def _digest() -> str:
    """A hash of the tracer's sources: the code of a compiled function depends on all functions that it calls."""
    sources = hashlib.sha256()
    for source in sorted(Path(__file__).parent.glob("*.py")):
        sources.update(source.read_bytes())
    return sources.hexdigest()[:16]


FOLDER = cache_folder() / "compiled" / _digest()


IS_KEPT = is_usable(FOLDER)
tell()

OPTIONS: dict[str, Any] = {
    "nogil": True,
    "cache": IS_KEPT,
    "error_model": "numpy",
    "forceinline": True,
    "_nrt": False,
    "fastmath": {"arcp", "nsz"},
}


def compiled(function: Function) -> Function:
    """Compile `function` to machine code that lets other threads run; it must not allocate arrays.

    It is inlined wherever another compiled function calls it, because a call would copy the tables of a scene, which
    are hundreds of words. Without allocations, no references to arrays are counted; this counting took most of the
    time. Arithmetic follows IEEE 754 as written, with two exceptions: a quotient may be a product with a reciprocal,
    and the sign of zero is not kept. So a picture is the same with any number of threads.
    """
    others = vars(numba.config)["CACHE_DIR"]
    vars(numba.config)["CACHE_DIR"] = str(FOLDER)
    try:
        result: Function = numba.njit(function, **OPTIONS)
    finally:
        vars(numba.config)["CACHE_DIR"] = others
    return result


def was_compiled() -> bool:
    """Whether an earlier process has compiled anything; if not, the first picture takes some twenty seconds."""
    return any(FOLDER.rglob("*.nbi"))
