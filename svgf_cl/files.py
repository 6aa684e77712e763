"""Files that are written whole or not at all, and the folders they lie in."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from svgf_cl.errors import SequenceError


@contextmanager
def written_whole(path: Path) -> Iterator[Path]:
    """Yield a name beside `path` to write to; the file becomes `path` when the block ends, and is gone if it raises.

    Raises
    ------
    SequenceError
        Where the file cannot be written; it names `path` and the system's reason.
    """
    aside = path.with_name(f".{path.name}.{os.getpid()}.tmp")
    try:
        yield aside
        os.replace(aside, path)
    except OSError as error:
        raise SequenceError(f"{path}: cannot be written ({error.strerror or error})") from error
    finally:
        if aside.exists():
            aside.unlink()


def make_folder(path: Path) -> Path:
    """Make the folder `path`, parents too, where it is not there yet; `SequenceError` where that is impossible."""
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise SequenceError(f"{path}: cannot be made a folder for the output ({error.strerror})") from error
    if not os.access(path, os.W_OK | os.X_OK):
        raise SequenceError(f"{path}: expected a folder that can be written to, got one that is read-only")
    return path
