"""Files that are written completely or not at all, their folders, and errors of both."""

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

ATTEMPTS = 10  # to act in a folder that other processes remove again


@contextmanager
def written_whole(path: Path) -> Iterator[Path]:
    """Yield an empty file beside `path` to write to; it becomes `path` when the block ends, and is gone if it raises.

    Folders that `path` lies in are made where they are missing, and are gone too if it raises.
    A process that is killed leaves its file under a name that nothing reads, ``.NAME.HOST-PROCESS.tmp``, and what was
    at `path` before; `output_folder` deletes it.

    Raises
    ------
    FileError
        Where the file cannot be written; it names `path` and the system's reason.
    """
    with _beside(path, Path.touch) as aside:
        yield aside
        _sync(aside)
        os.replace(aside, path)


@contextmanager
def folder_written_whole(path: Path) -> Iterator[Path]:
    """Yield an empty folder beside `path` to fill; it becomes `path` when the block ends, and is gone if it raises.

    All else is as with `written_whole`.

    Raises
    ------
    FileError
        Where something is at `path` already, or the folder cannot be written.
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
    """Make and yield what will be at `path`; it is gone if the block raises, and so are folders made for it."""
    aside = _aside(path)
    made: list[Path] = []
    try:
        made = _in_made(path.parent, lambda: make(aside))
        yield aside
    except BaseException as error:
        with contextlib.suppress(OSError):  # there may never have been one
            _discard(aside)
        _remove(made)
        if isinstance(error, OSError):
            raise FileError(f"{path}: cannot be written ({error.strerror or error})") from error
        raise


def check_new(path: Path) -> Path:
    """Return `path` for a folder that is still to be made; `FileError` where something is there already."""
    if os.path.lexists(path):
        raise FileError(f"{path}: expected a new folder, but it is there already; delete it, or name another")
    return path


def write_text(path: Path, text: str) -> None:
    """Write a text, completely or not at all; names of files that are not text are escaped as in Python.

    Raises
    ------
    FileError
        As `written_whole`.
    """
    with written_whole(path) as aside:
        aside.write_text(text, encoding="utf-8", errors="backslashreplace", newline="\n")


def output_folder(path: Path) -> Path:
    """Return the folder `path` for files that are still to be made, cleared of what killed processes left there.

    It is made with the first file, so that a run that fails before leaves no empty folder; that it can be made is found
    out here, before any work is done.

    Raises
    ------
    FileError
        Where it cannot be made or written to.
    """
    try:
        _remove(_in_made(path, lambda: try_to_write(path)))
    except OSError as error:
        raise FileError(f"{path}: cannot be a folder for the output ({error.strerror or error})") from error
    if path.is_dir():
        _delete_leftovers(path)
    return path


def output_file(path: Path) -> Path:
    """Return `path` for a file that is still to be made; errors as of `output_folder`, before any work is done."""
    output_folder(path.parent)
    if path.is_dir():
        raise FileError(f"{path}: expected a file to write, got a folder")
    return path


def try_to_write(folder: Path) -> None:
    """Write to a file without a name in `folder`; `OSError` where nothing can be written there."""
    with tempfile.TemporaryFile(dir=folder) as file:
        file.write(b"\0")
        file.flush()


def require(path: Path) -> None:
    """Raise `FileError` unless there is something at `path` that this user may look at."""
    try:
        path.stat()
    except FileNotFoundError as error:
        raise FileError(f"{path}: expected a file or a folder, found nothing there") from error
    except OSError as error:
        raise unreadable(path, error) from error


def entries(folder: Path) -> list[Path]:
    """What is in `folder`; `FileError` where it cannot be read."""
    try:
        return list(folder.iterdir())
    except OSError as error:
        raise unreadable(folder, error) from error


def unreadable(path: Path, error: OSError) -> FileError:
    """Make the error for a file or folder that is there but cannot be read."""
    return FileError(f"{path}: cannot be read ({error.strerror or error})")


def read_json(path: Path) -> Any:
    """Read a JSON file that anyone may have damaged.

    Raises
    ------
    OSError
        It cannot be read.
    ValueError
        It is no JSON, or nested so deeply that nobody meant it.
    """
    try:
        return json.loads(path.read_bytes())
    except RecursionError as error:
        raise ValueError("nested too deeply") from error


def _aside(path: Path) -> Path:
    """Where this process writes what will be at `path`."""
    return path.with_name(f".{path.name}.{socket.gethostname()}-{os.getpid()}.tmp")


def _discard(path: Path) -> None:
    """Delete a file or a folder with all that is in it."""
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path, ignore_errors=True)
    else:
        path.unlink(missing_ok=True)


def _in_made(folder: Path, act: Callable[[], object]) -> list[Path]:
    """Make a folder as `_make` does and act in it; return what was made, which is gone if it raises.

    Tasks of a farm begin at the same time, and each removes again what it made to try it out: where another one did so
    in between, all is done once more.
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
    """Make a folder and those that it lies in, as far as they are missing; return what was made, innermost first."""
    missing = [place for place in (folder, *folder.parents) if not os.path.lexists(place)]
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:
        _remove(missing)
        raise
    return missing


def _remove(folders: Sequence[Path]) -> None:
    """Remove folders, each before the one that it lies in, as far as they are there and empty."""
    for folder in folders:
        with contextlib.suppress(OSError):
            folder.rmdir()


def _sync(path: Path) -> None:
    """Wait until the file is on the disk: only then is it known that there was room, and is it whole after a crash."""
    descriptor = os.open(path, os.O_RDWR)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def _delete_leftovers(folder: Path) -> None:
    """Delete what processes of this machine were writing to `folder` when they were killed."""
    left = re.compile(rf"\..+\.{re.escape(socket.gethostname())}-(\d{{1,9}})\.tmp")
    for path in folder.iterdir():
        match = left.fullmatch(path.name)
        if match and not _is_running(int(match[1])):
            _discard(path)


def _is_running(process: int) -> bool:
    """Whether there is a process with this number; True if the system does not say."""
    if os.name != "posix":
        return True
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except OSError:  # another user's
        return True
    return True
