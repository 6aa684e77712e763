"""How the tracer's inner loops are compiled: by Numba, at their first call, kept on disk for the next process."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

import numba

Function = TypeVar("Function", bound=Callable[..., object])


def compiled(function: Function) -> Function:
    """Compile `function` to machine code that lets the other threads run.

    Arithmetic follows IEEE 754 as written: a picture is the same with every number of threads.
    """
    result: Function = numba.njit(function, nogil=True, cache=True, error_model="numpy")
    return result
