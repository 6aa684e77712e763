"""Finds the files that an OBJ or MTL file refers to."""

from __future__ import annotations

import re
import unicodedata
from pathlib import Path, PurePosixPath


def found_inside(root: Path, name: str, beside: Path) -> Path | None:
    """The file `name`, relative to the folder `beside` or else to `root`; None if `root` does not contain it.

    No file outside `root` is found. Names may come from other systems: a backslash separates folders, too. If no name
    matches exactly, a name that differs only in case matches.
    """
    parts = PurePosixPath(name.strip().strip('"').replace("\\", "/")).parts
    if not parts or parts[0] == "/" or re.match(r"[A-Za-z]:", parts[0]):
        return None
    for folder in (beside, root):
        try:
            path = _descended(folder, parts)
            if path and path.is_file() and path.resolve().is_relative_to(root.resolve()):
                return path
        except (OSError, RuntimeError, ValueError):  # a name that is too long or has a zero byte, or a loop of links
            return None
    return None


def _descended(folder: Path, parts: tuple[str, ...]) -> Path | None:
    for part in parts:
        if part == ".." or (folder / part).exists():
            folder = folder / part
            continue
        alike = sorted(entry for entry in folder.iterdir() if _folded(entry.name) == _folded(part))
        if not alike:
            return None
        folder = alike[0]
    return folder


def _folded(name: str) -> str:
    """`name` in lower case, with accents in one normal form."""
    return unicodedata.normalize("NFC", name).casefold()
