"""Finds the frames of a shot by their file names, sorts them by number, and checks them.

The number of a frame is the last one in its name, with any padding: ``frame.0007.exr``, ``shot_7.exr``, ``0007.exr``. A
minus belongs to the number if it follows a dot or an underscore, or begins the name: ``frame.-0002.exr``. The rest of
the name is the same in all frames of a shot.
"""

from __future__ import annotations

import re
import warnings
from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

from svgf_cl.errors import FileError
from svgf_cl.io.atomic import entries, require, unreadable
from svgf_cl.io.patterns import expanded

NUMBER = re.compile(r"(?P<head>.*?)(?P<digits>(?:(?<![^._])-)?[0-9]+)(?P<tail>[^0-9]*)", re.DOTALL)
# `svgf-cl render` writes both to one folder. The texts are those around the number.
OTHERS = {"frame": ("reference.", ".exr"), "reference": ("frame.", ".exr")}
# Pictures that a command may have written, whatever the names of its frames.
WRITTEN = {("frame.", ".exr"), ("reference.", ".exr"), ("frame.", ".png"), ("still.", ".png")}
NO_NUMBER = 0  # the frame number of a file without a number in its name
SHOWN = 4  # names or gaps that a message lists


@dataclass(frozen=True)
class Name:
    """A file's name, split at its number.

    Parameters
    ----------
    path : Path
    head, digits, tail : str
        Together they are the name: ``frame.``, ``-0002``, ``.exr``.
    """

    path: Path
    head: str
    digits: str
    tail: str

    @classmethod
    def of(cls, path: Path) -> Name | None:
        """Split the name of `path`; None if it has no number."""
        match = NUMBER.fullmatch(path.name)
        return cls(path, **match.groupdict()) if match else None

    @property
    def number(self) -> int:
        """The frame's number."""
        return int(self.digits)

    @property
    def shot(self) -> tuple[str, str]:
        """The texts around the number, which are the same in all frames of a shot."""
        return self.head, self.tail

    def is_padded(self, width: int) -> bool:
        """Whether the number is padded to `width` digits; a minus may be one of them."""
        return self.digits in (f"{self.number:0{width}d}", f"-{-self.number:0{width}d}")


def frame_number(path: Path) -> int | None:
    """Return the number in a name such as ``frame.0007.exr``; None if there is none."""
    name = Name.of(path)
    return name.number if name else None


def number_of(path: Path) -> int:
    """Return the number in a file's name, or `NO_NUMBER`."""
    number = frame_number(path)
    return NO_NUMBER if number is None else number


def find_frames(paths: Iterable[Path], *, allow_gaps: bool = False) -> list[Path]:
    """Find the frames of one shot, in the order of their numbers.

    Parameters
    ----------
    paths : iterable of Path
        Files in any order, patterns of names, or a folder of frames. A single file needs no number.
    allow_gaps : bool
        Accept a shot that lacks frames; `after_gaps` says where.

    Returns
    -------
    list of Path

    Raises
    ------
    FileError
        If a path is missing, a folder has no frame, files belong to several shots or have no number, a number or a file
        occurs twice, or a frame between two others is missing.

    Warns
    -----
    UserWarning
        If files in the folder look like frames but are not, or numbers are padded in several ways.
    """
    found: list[Path] = []
    for path in (each for given in paths for each in expanded(given)):
        require(path)
        found += shot_in(path) if path.is_dir() else [path]
    frames = in_order(found)
    if not allow_gaps:
        check_gaps(frames)
    return frames


def find_numbered(folder: Path, stem: str) -> list[Path]:
    """Return the pictures of a folder, sorted by number: its ``stem.NUMBER.exr``, or else its only sequence.

    There may be gaps.

    Raises
    ------
    FileError
        As in `find_frames`.
    """
    return in_order(shot_in(folder, stem))


def shot_in(folder: Path, stem: str = "frame") -> list[Path]:
    """Return the only numbered sequence of EXR files in a folder; errors and warnings as in `find_frames`."""
    visible = [path for path in entries(folder) if not path.name.startswith(".")]
    names = [name for path in visible if path.suffix.lower() == ".exr" and (name := Name.of(path))]
    ours = [name for name in names if name.shot != OTHERS[stem]] or names
    if not ours:
        raise FileError(
            f"{folder}: expected files named {stem}.0000.exr and so on in this folder, or "
            "of another name with a number, found none"
        )
    check_one_shot(ours)
    strangers = look_alikes(ours, visible)
    if strangers:
        warnings.warn(
            f"{folder}: not read, but named almost like {ours[0].path.name}: {listed(strangers)}", stacklevel=4
        )
    return [name.path for name in ours]


def look_alikes(shot: Sequence[Name], paths: Iterable[Path]) -> list[str]:
    """Return names of files that look like frames of a shot but are not, except a frame's files in other formats."""
    numbers = {name.number for name in shot}
    start = re.compile(re.escape(shot[0].head.rstrip("._- ")) or r"-?[0-9]", re.IGNORECASE)
    frames = {name.path for name in shot}
    return sorted(
        path.name
        for path in paths
        if path not in frames
        and start.match(path.name)
        and (".exr" in path.name.lower() or Name.of(path))
        and frame_number(path) not in numbers
        and path.is_file()
    )


def in_order(files: Sequence[Path]) -> list[Path]:
    """Sort the files of one shot by number; errors and warnings as in `find_frames`."""
    if len(files) == 1:
        return list(files)
    names = []
    for path in files:
        name = Name.of(path)
        if name is None:
            raise FileError(f"{path}: expected a number in the name of each frame, found none; number the files")
        names.append(name)
    check_one_shot(names)
    names.sort(key=lambda name: name.number)
    check_doubles(names)
    widths = {1, *(len(name.digits.lstrip("-")) for name in names)}
    usual = max(widths, key=lambda width: sum(name.is_padded(width) for name in names))
    odd = [name.path.name for name in names if not name.is_padded(usual)]
    if odd:
        warnings.warn(
            f"{listed(odd)}: padded in another way than the other frames, so perhaps from another run; "
            "read as the same shot",
            stacklevel=3,
        )
    return [name.path for name in names]


def check_one_shot(names: Sequence[Name]) -> None:
    """Raise `FileError` if files differ in more than their numbers, or are in several folders."""
    shots: dict[object, list[Path]] = {}
    for name in names:
        shots.setdefault((name.path.parent.resolve(), name.shot), []).append(name.path)
    if len(shots) > 1:
        found = [f"{min(paths)} ({len(paths)} of its kind)" for paths in shots.values()]
        raise FileError(
            f"{listed(found)}: expected the frames of one shot, in one folder, whose names differ only in the last "
            f"number, found {len(shots)} kinds; give the files of one kind, or rename files that belong to it"
        )


def check_doubles(names: Sequence[Name]) -> None:
    """Raise `FileError` if a file or a number occurs twice; the files are sorted by number."""
    seen: dict[tuple[int, int], Path] = {}
    for name in names:
        key = identity(name.path)
        if key in seen:
            raise FileError(f"{name.path}: expected every file once, got it also as {seen[key]}; give it once")
        seen[key] = name.path
    for before, after in pairwise(names):
        if before.number == after.number:
            raise FileError(
                f"{after.path}: expected one file for frame {after.number}, found {before.path} too; "
                "leave one of them out"
            )


def identity(path: Path) -> tuple[int, int]:
    """Return the identity of a file, which is the same for all links to it."""
    try:
        status = path.stat()
    except OSError as error:
        raise unreadable(path, error) from error
    return status.st_dev, status.st_ino


def check_gaps(files: Sequence[Path]) -> None:
    """Raise `FileError` if a number is missing: the next frame's motion would refer to the wrong frame."""
    names = [name for path in files if (name := Name.of(path))]
    gaps = [(before, after) for before, after in pairwise(names) if after.number > before.number + 1]
    if not gaps:
        return
    before, after = gaps[0]
    first, width = before.number + 1, min(len(name.digits.lstrip("-")) for name in (before, after))
    missing = before.path.with_name(f"{before.head}{'-' * (first < 0)}{abs(first):0{width}d}{before.tail}")
    spans = [spanned(before.number + 1, after.number - 1) for before, after in gaps]
    raise FileError(
        f"{missing}: expected this frame between {before.path.name} and {after.path.name}, found none; all missing "
        f"frames: {listed(spans)}; render them, or use --allow-gaps to start again after each gap"
    )


def after_gaps(files: Sequence[Path]) -> set[Path]:
    """Return the frames that follow a gap: their motion refers to a missing frame. The files are sorted by number."""
    numbered = [(path, frame_number(path) or 0) for path in files]
    return {after for (_, before), (after, number) in pairwise(numbered) if number != before + 1}


def check_leftovers(folder: Path, written: Collection[Path]) -> None:
    """Raise `FileError` if `folder` has pictures of an earlier run that would look like a part of this one."""
    new = set(written)
    heads = {name.head for path in new if (name := Name.of(path))}
    known = WRITTEN | {(head, suffix) for head in heads for suffix in (".exr", ".png")}
    for path in sorted(entries(folder) if folder.is_dir() else []):
        name = Name.of(path)
        if name and (name.head, name.tail.lower()) in known and path not in new:
            raise FileError(f"{path}: left by an earlier run of another length; delete it, or choose another folder")


def listed(names: Sequence[str]) -> str:
    """Return a text with the first few names, and how many more there are."""
    more = len(names) - SHOWN
    return ", ".join(names[:SHOWN]) + (f" and {more} more" if more > 0 else "")


def spanned(first: int, last: int) -> str:
    """Return the frames of a gap as a text."""
    return str(first) if first == last else f"{first} to {last}"
