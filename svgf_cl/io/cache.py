"""The cache folder of svgf_cl, and what happens if it cannot be written."""

from __future__ import annotations

import atexit
import errno
import functools
import os
import shutil
import tempfile
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import platformdirs
import pyopencl as cl

from svgf_cl.errors import FileError
from svgf_cl.io.atomic import try_to_write

# Binaries of all kernels and of the tracer, and some more: on a disk with less room left, writers fail half way.
ROOM = 64 * 2**20

# In place of a cache folder for a user without a home: nothing can be read or written there.
NOWHERE = Path(os.devnull, "no home folder")

# What can be written in a container that is read-only as a whole.
SHARED_MEMORY = "/dev/shm"

_problems: list[str] = []
_told: list[str] = []


def cache_folder() -> Path:
    """Return the platform's per-user cache folder of svgf_cl; it need not exist, and may not be writable."""
    return users_folder("svgf_cl")


def users_folder(name: str) -> Path:
    """Return the user's cache folder of the program `name`, by the rules of the platform."""
    try:
        folder = platformdirs.user_cache_path(name, appauthor=name if name != "svgf_cl" else False)
    except RuntimeError:  # neither HOME nor an entry in passwd
        return NOWHERE / name
    # Older versions of platformdirs begin it with "~" then: in the current folder, which may be anyone's.
    return folder if folder.is_absolute() else NOWHERE / name


@functools.cache
def is_usable(folder: Path) -> bool:
    """Whether files can be kept in a cache folder, be it there or still to be made; tried once in a process.

    Where they cannot, `tell` says so.
    """
    try:
        _try(folder)
    except OSError as error:
        _problems.append(f"{folder}: cannot be written ({error.strerror or error})")
        return False
    return True


def tell() -> None:
    """Warn once in a process that a folder cannot be written: which folder, what that costs, and what helps."""
    if _problems and not _told:
        _told.append(_problems[0])
        warnings.warn(
            f"{_told[0]}; everything works without it, but each run tests devices, builds kernels and compiles "
            "the tracer again, and references are not stored; set XDG_CACHE_HOME to a folder that can be written",
            stacklevel=2,
        )


@contextmanager
def keeping() -> Iterator[None]:
    """A context for writing to a cache: if that fails, `tell` warns, and there is no error."""
    try:
        yield
    except (OSError, FileError) as error:
        _problems.append(str(error))
        tell()


@functools.cache
def temporary_folder() -> Path:
    """A folder for what must be written somewhere, in place of a cache; it is deleted when this process ends.

    Raises
    ------
    OSError
        Where no temporary folder can be made either, not even in shared memory.
    """
    try:
        folder = Path(tempfile.mkdtemp(prefix="svgf_cl-"))
    except OSError:
        folder = Path(tempfile.mkdtemp(prefix="svgf_cl-", dir=SHARED_MEMORY))
    atexit.register(_delete, folder, os.getpid())
    return folder


def device_key(device: cl.Device) -> str:
    """Return what identifies a device together with its driver; equal devices share it."""
    return " | ".join((device.platform.name, device.platform.version, device.name, device.driver_version))


def _try(folder: Path) -> None:
    """Write to a folder, or where it would be made; nothing stays there."""
    place = folder
    while not os.path.lexists(place):
        place = place.parent
    try_to_write(place)
    room = shutil.disk_usage(place)
    if room.total and room.free < ROOM:
        raise OSError(errno.ENOSPC, f"less than {ROOM >> 20} MiB of room")


def _delete(folder: Path, owner: int) -> None:
    if os.getpid() == owner:  # and not a fork of it
        shutil.rmtree(folder, ignore_errors=True)
