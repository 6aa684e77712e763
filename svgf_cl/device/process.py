"""OpenCL does not survive a fork: drivers' threads are gone, and calls hang. A forked process is told so at once."""

from __future__ import annotations

import os

from svgf_cl.errors import DeviceError

_first_user: list[int] = []  # the process that used OpenCL first; a fork copies it


def check_process() -> None:
    """Raise `DeviceError` in a process that was forked from one that had used OpenCL."""
    if not _first_user:
        _first_user.append(os.getpid())
    if _first_user[0] != os.getpid():
        raise DeviceError(
            "this process was forked from one that had used OpenCL, which does not survive a fork; start processes "
            "with multiprocessing.get_context('spawn'), or fork before the first Denoiser is made"
        )
