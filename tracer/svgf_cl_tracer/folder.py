"""The files that an OBJ or MTL file names, beside it."""

from __future__ import annotations

import re
import unicodedata
from pathlib import Path, PurePosixPath


def found_inside(root: Path, name: str, beside: Path) -> Path | None:
    """The file called `name` as seen from the folder `beside`, or else from `root`; None where `root` holds none.

    Nothing outside `root` is found. Names come from other systems: a backslash separates folders too, and where no name
    is the same, one that differs in case alone is.
    """
    parts = PurePosixPath(name.strip().strip('"').replace("\\", "/")).parts
    if not parts or parts[0] == "/" or re.match(r"[A-Za-z]:", parts[0]):
        return None
    for folder in (beside, root):
        try:
            path = _descended(folder, parts)
            if path and path.is_file() and path.resolve().is_relative_to(root.resolve()):
                return path
        except (OSError, RuntimeError, ValueError):  # a name too long or with a zero in it, a loop of links
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
    """`name` without its case, and with its accents written in one way."""
    return unicodedata.normalize("NFC", name).casefold()
