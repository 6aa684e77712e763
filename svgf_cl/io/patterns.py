"""Patterns of numbered files: ``shot/beauty.####.exr``, ``shot/beauty.%04d.exr``, ``shot/*.exr``."""

from __future__ import annotations

import os
import re
from pathlib import Path

from svgf_cl.errors import FileError, SvgfError, shown
from svgf_cl.io.atomic import entries, require

# The place of the number: a run of #, or %d as in C.
NUMBER = re.compile(r"#+|%(?:0(?P<width>[1-9]))?d")
GLOB = re.compile(r"[*?\[]")
RANGE = re.compile(r"(?P<first>-?\d{1,9})(?:-(?P<last>-?\d{1,9}))?", re.ASCII)


def expanded(path: Path) -> list[Path]:
    """Return the files that match a pattern; a path without a pattern stands for itself.

    Raises
    ------
    FileError
        If no file matches the pattern, or it has more than one number.
    """
    if os.path.exists(path) or not (NUMBER.search(path.name) or GLOB.search(path.name)):
        return [path]
    require(path.parent)
    if NUMBER.search(path.name):
        head, tail = around_number(path)
        minus = "-?" if not head or head[-1] in "._" else ""  # else a minus belongs to the name
        fits = re.compile(f"{re.escape(head)}{minus}[0-9]+{re.escape(tail)}")
        found = [entry for entry in entries(path.parent) if fits.fullmatch(entry.name)]
    else:
        found = [entry for entry in path.parent.glob(path.name) if not entry.name.startswith(".")]
    if not found:
        raise FileError(f"{path}: expected files of this pattern, found none{neighbour(path)}")
    return sorted(found)


def neighbour(path: Path) -> str:
    """Return, for a message, a file that is there although it does not match the pattern; empty if there is none."""
    suffix = path.suffix.lower()
    visible = (entry for entry in entries(path.parent) if not entry.name.startswith("."))
    names = sorted(entry.name for entry in visible if entry.suffix.lower() == suffix != "")
    return f"; the folder has {shown(names[0])}" if names else ""


def has_number(path: Path) -> bool:
    """Whether a name has a place for a number, and is no existing folder."""
    return bool(NUMBER.search(path.name)) and not path.is_dir()


def numbered(pattern: Path, number: int) -> Path:
    """Return the EXR file of a pattern and a number, padded as in the pattern.

    Raises
    ------
    FileError
        If the pattern has more than one number, or does not end in ``.exr``.
    """
    head, tail = around_number(pattern)
    if not tail.lower().endswith(".exr"):
        raise FileError(f"{pattern}: expected a pattern that ends in .exr, such as ####.exr, or a folder")
    match = NUMBER.search(pattern.name)
    width = 1 if match is None else len(match[0]) if match[0].startswith("#") else int(match["width"] or 1)
    return pattern.with_name(f"{head}{'-' * (number < 0)}{abs(number):0{width}d}{tail}")


def around_number(pattern: Path) -> tuple[str, str]:
    """Return the texts before and after the number."""
    parts = NUMBER.sub("\0", pattern.name).split("\0")
    if len(parts) != 2:
        raise FileError(f"{pattern}: expected one number, as #### or %04d, got {len(parts) - 1}")
    return parts[0], parts[1]


def parse_range(text: str) -> tuple[int, int]:
    """Read ``1-120`` or ``7`` as the first and the last number."""
    match = RANGE.fullmatch(text)
    first, last = (int(match["first"]), int(match["last"] or match["first"])) if match else (1, 0)
    if last < first:
        raise SvgfError(f"--frames: expected FIRST-LAST such as 1-120, or one number, got {shown(text)}")
    return first, last
