"""Writes files and folders completely or not at all, checks them, and makes their errors."""

from __future__ import annotations

import contextlib
import json
import os
import re
import shutil
import socket
import tempfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from svgf_cl.errors import FileError

ATTEMPTS = 10  # to use a folder that other processes may remove at the same time


@contextmanager
def written_whole(path: Path) -> Iterator[Path]:
    """Yield an empty file beside `path` to write to; it becomes `path` when the block ends.

    If the block raises an error, the file is deleted. Missing parent folders of `path` are made, and removed after an
    error. If the process is killed, the file stays as ``.NAME.HOST-PROCESS.tmp``, which nothing reads, and `path` is
    unchanged; `output_folder` deletes such files.

    Raises
    ------
    FileError
        If the file cannot be written; the message names `path` and the system's reason.
    """
    with _beside(path, Path.touch) as aside:
        yield aside
        _sync(aside)
        os.replace(aside, path)


@contextmanager
def folder_written_whole(path: Path) -> Iterator[Path]:
    """Yield an empty folder beside `path` to fill; it becomes `path` when the block ends.

    Errors and killed processes are handled as in `written_whole`.

    Raises
    ------
    FileError
        If `path` exists already, or the folder cannot be written.
    """
    with _beside(path, Path.mkdir) as aside:
        yield aside
        for file in aside.rglob("*"):
            if file.is_file():
                _sync(file)
        check_new(path)  # a rename would replace an empty folder
        aside.rename(path)


@contextmanager
def _beside(path: Path, make: Callable[[Path], object]) -> Iterator[Path]:
    """Make and yield the file or folder that will be at `path`.

    If the block raises an error, it and the folders made for it are deleted.
    """
    aside = _aside(path)
    made: list[Path] = []
    try:
        made = _in_made(path.parent, lambda: make(aside))
        yield aside
    except BaseException as error:
        with contextlib.suppress(OSError):  # it may not exist
            _discard(aside)
        _remove(made)
        if isinstance(error, OSError):
            raise FileError(f"{path}: cannot be written ({error.strerror or error})") from error
        raise


def check_new(path: Path) -> Path:
    """Return `path` for a folder to make; raise `FileError` if `path` exists already."""
    if os.path.lexists(path):
        raise FileError(f"{path}: expected a new folder, but it is there already; delete it, or name another")
    return path


def write_text(path: Path, text: str) -> None:
    """Write a text completely or not at all; bytes of file names that are not UTF-8 are escaped as in Python.

    Raises
    ------
    FileError
        If the file cannot be written.
    """
    with written_whole(path) as aside:
        aside.write_text(text, encoding="utf-8", errors="backslashreplace", newline="\n")


def output_folder(path: Path) -> Path:
    """Check that `path` can be a folder for output files, delete leftovers of killed processes there, and return it.

    The check comes before any work is done. The folder itself is made with its first file, so that a run that fails
    before that leaves no empty folder.

    Raises
    ------
    FileError
        If the folder cannot be made or written to.
    """
    try:
        _remove(_in_made(path, lambda: try_to_write(path)))
    except OSError as error:
        raise FileError(f"{path}: cannot be a folder for the output ({error.strerror or error})") from error
    if path.is_dir():
        _delete_leftovers(path)
    return path


def output_file(path: Path) -> Path:
    """Check that `path` can be an output file, before any work is done, and return it.

    Raises
    ------
    FileError
        If it is a folder, or its folder cannot be made or written to.
    """
    output_folder(path.parent)
    if path.is_dir():
        raise FileError(f"{path}: expected a file to write, got a folder")
    return path


def try_to_write(folder: Path) -> None:
    """Write to a nameless file in `folder`; raise `OSError` if files cannot be written there."""
    with tempfile.TemporaryFile(dir=folder) as file:
        file.write(b"\0")
        file.flush()


def require(path: Path) -> None:
    """Raise `FileError` unless `path` exists and this user may access it."""
    try:
        path.stat()
    except FileNotFoundError as error:
        raise FileError(f"{path}: expected a file or a folder, found nothing there") from error
    except OSError as error:
        raise unreadable(path, error) from error


def entries(folder: Path) -> list[Path]:
    """Return the paths in `folder`; raise `FileError` if it cannot be read."""
    try:
        return list(folder.iterdir())
    except OSError as error:
        raise unreadable(folder, error) from error


def unreadable(path: Path, error: OSError) -> FileError:
    """Return the error for a file or folder that exists but cannot be read."""
    return FileError(f"{path}: cannot be read ({error.strerror or error})")


def read_json(path: Path) -> Any:
    """Read a JSON file that may be damaged.

    Raises
    ------
    OSError
        If it cannot be read.
    ValueError
        If it is not JSON, or nested too deeply for the parser.
    """
    try:
        return json.loads(path.read_bytes())
    except RecursionError as error:
        raise ValueError("nested too deeply") from error


def _aside(path: Path) -> Path:
    """Return the path that this process writes to before it becomes `path`."""
    return path.with_name(f".{path.name}.{socket.gethostname()}-{os.getpid()}.tmp")


def _discard(path: Path) -> None:
    """Delete a file, or a folder with its content."""
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path, ignore_errors=True)
    else:
        path.unlink(missing_ok=True)


def _in_made(folder: Path, act: Callable[[], object]) -> list[Path]:
    """Make a folder as `_make` does, and call `act`; return the folders that were made.

    After an error these folders are removed again. Tasks of a farm begin at the same time, and each removes the folders
    that it made for a test. If another task removes the folder before `act`, everything is repeated.
    """
    made: list[Path] = []
    try:
        for left in reversed(range(ATTEMPTS)):
            try:
                made += _make(folder)
                act()
                break
            except FileNotFoundError:
                if not left:
                    raise
    except BaseException:
        _remove(made)
        raise
    return made


def _make(folder: Path) -> list[Path]:
    """Make a folder and its missing parents; return the folders that were made, innermost first."""
    missing = [place for place in (folder, *folder.parents) if not os.path.lexists(place)]
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:
        _remove(missing)
        raise
    return missing


def _remove(folders: Sequence[Path]) -> None:
    """Remove those of the folders that exist and are empty; they are given innermost first."""
    for folder in folders:
        with contextlib.suppress(OSError):
            folder.rmdir()


def _sync(path: Path) -> None:
    """Wait until the file is on the disk: only then is it certain that there was room, and that it survives a crash."""
    descriptor = os.open(path, os.O_RDWR)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def _delete_leftovers(folder: Path) -> None:
    """Delete files that processes of this machine were writing to `folder` when they were killed."""
    left = re.compile(rf"\..+\.{re.escape(socket.gethostname())}-(\d{{1,9}})\.tmp")
    for path in folder.iterdir():
        match = left.fullmatch(path.name)
        if match and not _is_running(int(match[1])):
            _discard(path)


def _is_running(process: int) -> bool:
    """Whether a process with this number is running; True if the system does not say."""
    if os.name != "posix":
        return True
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except OSError:  # another user's process
        return True
    return True
