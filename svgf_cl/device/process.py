"""Detects a forked process: drivers' threads do not survive a fork, so that OpenCL calls there would hang."""

from __future__ import annotations

import os

from svgf_cl.errors import DeviceError

_first_user: list[int] = []  # the process that used OpenCL first; a fork copies it


def is_forked() -> bool:
    """Whether this process was forked from one that had used OpenCL."""
    return bool(_first_user) and _first_user[0] != os.getpid()


def check_process() -> None:
    """Raise `DeviceError` if this process was forked from one that had used OpenCL; else note that this one uses it."""
    if not _first_user:
        _first_user.append(os.getpid())
    if is_forked():
        raise DeviceError(
            "this process was forked from one that had used OpenCL, which does not survive a fork; start processes "
            "with multiprocessing.get_context('spawn'), or fork before the first Denoiser is made"
        )
