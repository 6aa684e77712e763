"""The cache folder of svgf_cl, and warnings if it cannot be written."""

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

# Enough for the binaries of all kernels and of the tracer: on a disk with less room, writers would fail half-way.
ROOM = 64 * 2**20

# Stands for the cache folder of a user without a home; nothing can be read or written there.
NOWHERE = Path(os.devnull, "no home folder")

# A folder that is writable even in a read-only container.
SHARED_MEMORY = "/dev/shm"

_problems: list[str] = []
_told: list[str] = []


def cache_folder() -> Path:
    """Return the platform's per-user cache folder of svgf_cl, which may be missing or not writable."""
    return users_folder("svgf_cl")


def users_folder(name: str) -> Path:
    """Return the user's cache folder of the program `name`, by the rules of the platform."""
    try:
        folder = platformdirs.user_cache_path(name, appauthor=name if name != "svgf_cl" else False)
    except RuntimeError:  # there is neither HOME nor an entry in passwd
        return NOWHERE / name
    # Older versions of platformdirs return a path that begins with "~" then, which would be in the current folder.
    return folder if folder.is_absolute() else NOWHERE / name


@functools.cache
def is_usable(folder: Path) -> bool:
    """Whether files can be written to a cache folder, which may not exist yet; tested once in a process.

    If not, `tell` warns.
    """
    try:
        _try(folder)
    except OSError as error:
        _problems.append(f"{folder}: cannot be written ({error.strerror or error})")
        return False
    return True


def tell() -> None:
    """Warn once in a process if a cache folder cannot be written: name the folder, the consequences and the remedy."""
    if _problems and not _told:
        _told.append(_problems[0])
        warnings.warn(
            f"{_told[0]}; everything works without it, but each run tests devices, builds kernels and compiles "
            "the tracer again, and references are not stored; set XDG_CACHE_HOME to a folder that can be written",
            stacklevel=2,
        )


@contextmanager
def keeping() -> Iterator[None]:
    """Return a context for writing to a cache: if that fails, `tell` warns, and there is no error."""
    try:
        yield
    except (OSError, FileError) as error:
        _problems.append(str(error))
        tell()


@functools.cache
def temporary_folder() -> Path:
    """Return a folder to use instead of a cache folder; it is deleted when this process ends.

    Raises
    ------
    OSError
        If no temporary folder can be made, not even in shared memory.
    """
    try:
        folder = Path(tempfile.mkdtemp(prefix="svgf_cl-"))
    except OSError:
        folder = Path(tempfile.mkdtemp(prefix="svgf_cl-", dir=SHARED_MEMORY))
    atexit.register(_delete, folder, os.getpid())
    return folder


def device_key(device: cl.Device) -> str:
    """Return the key of a device and its driver; equal devices have the same key."""
    return " | ".join((device.platform.name, device.platform.version, device.name, device.driver_version))


def _try(folder: Path) -> None:
    """Test that a folder, or its nearest parent that exists, can be written to; raise `OSError` if not."""
    place = folder
    while not os.path.lexists(place):
        place = place.parent
    try_to_write(place)
    room = shutil.disk_usage(place)
    if room.total and room.free < ROOM:
        raise OSError(errno.ENOSPC, f"less than {ROOM >> 20} MiB of room")


def _delete(folder: Path, owner: int) -> None:
    if os.getpid() == owner:  # not in a fork of the owner
        shutil.rmtree(folder, ignore_errors=True)
