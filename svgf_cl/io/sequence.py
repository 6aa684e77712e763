"""Which files are the frames of a shot, and in which order: told from their names, and checked before they are trusted.

The number of a frame is the last one in its name, in any padding: ``frame.0007.exr``, ``shot_7.exr``, ``0007.exr``. A
minus behind a dot, an underscore or nothing belongs to it: ``frame.-0002.exr``. What is around the number is the same
in all frames of a shot.
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
# A folder that svgf-cl has rendered to holds both; by what is around their numbers.
OTHERS = {"frame": ("reference.", ".exr"), "reference": ("frame.", ".exr")}
# Pictures that some command may have written, whatever the names of its frames.
WRITTEN = {("frame.", ".exr"), ("reference.", ".exr"), ("frame.", ".png"), ("still.", ".png")}
NO_NUMBER = 0  # of the frame of a file that has none in its name
SHOWN = 4  # names or gaps that a message lists


@dataclass(frozen=True)
class Name:
    """A file's name, taken apart at its number.

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
        """Take the name of `path` apart; None where there is no number in it."""
        match = NUMBER.fullmatch(path.name)
        return cls(path, **match.groupdict()) if match else None

    @property
    def number(self) -> int:
        """The frame's place in its sequence."""
        return int(self.digits)

    @property
    def shot(self) -> tuple[str, str]:
        """What all frames of a shot have in common."""
        return self.head, self.tail

    def is_padded(self, width: int) -> bool:
        """Whether the number is written in at least so many digits; a minus may be one of them."""
        return self.digits in (f"{self.number:0{width}d}", f"-{-self.number:0{width}d}")


def frame_number(path: Path) -> int | None:
    """Return the number in a name like ``frame.0007.exr``; None where there is none."""
    name = Name.of(path)
    return name.number if name else None


def number_of(path: Path) -> int:
    """The number in a file's name, or `NO_NUMBER`."""
    number = frame_number(path)
    return NO_NUMBER if number is None else number


def find_frames(paths: Iterable[Path], *, allow_gaps: bool = False) -> list[Path]:
    """Find the frames of one shot, in the order of their numbers.

    Parameters
    ----------
    paths : iterable of Path
        Files in any order, patterns of their names, or the folder that holds them. A single file needs no number.
    allow_gaps : bool
        Take a shot that lacks frames; `after_gaps` tells where.

    Returns
    -------
    list of Path

    Raises
    ------
    FileError
        A path is missing; a folder holds no frame; files are of several shots, or without a number; a number or a file
        is there twice; a frame between two others is not there.

    Warns
    -----
    UserWarning
        Files of the folder look like frames, but are not; numbers are padded in several ways.
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
    """Find the pictures of a folder by number, gaps or not: its ``stem.NUMBER.exr``, or the one sequence it holds.

    Raises
    ------
    FileError
        As `find_frames`.
    """
    return in_order(shot_in(folder, stem))


def shot_in(folder: Path, stem: str = "frame") -> list[Path]:
    """Find the one numbered sequence of EXR files in a folder; errors and warnings as of `find_frames`."""
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
    """Names of files that may have been meant as frames of a shot, but are none; not of a frame's other formats."""
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
    """Sort the files of one shot by number; errors and warnings as of `find_frames`."""
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
            f"{listed(odd)}: padded in another way than other frames, so perhaps of another run; read as the same shot",
            stacklevel=3,
        )
    return [name.path for name in names]


def check_one_shot(names: Sequence[Name]) -> None:
    """Raise `FileError` where files differ in more than their numbers, or lie in several folders."""
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
    """Raise `FileError` where a file, or a number, is there twice among files that are sorted by number."""
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
    """What a file is known by, however many links lead to it."""
    try:
        status = path.stat()
    except OSError as error:
        raise unreadable(path, error) from error
    return status.st_dev, status.st_ino


def check_gaps(files: Sequence[Path]) -> None:
    """Raise `FileError` where a number is missing: the next frame's motion would lead to the wrong one."""
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
    """Which of some frames in order follow on a gap: the motion in them leads to a frame that is not there."""
    numbered = [(path, frame_number(path) or 0) for path in files]
    return {after for (_, before), (after, number) in pairwise(numbered) if number != before + 1}


def check_leftovers(folder: Path, written: Collection[Path]) -> None:
    """Raise `FileError` where pictures of an earlier run would stay in `folder` and pass for a part of this one."""
    new = set(written)
    heads = {name.head for path in new if (name := Name.of(path))}
    known = WRITTEN | {(head, suffix) for head in heads for suffix in (".exr", ".png")}
    for path in sorted(entries(folder) if folder.is_dir() else []):
        name = Name.of(path)
        if name and (name.head, name.tail.lower()) in known and path not in new:
            raise FileError(f"{path}: left by an earlier run of another length; delete it, or choose another folder")


def listed(names: Sequence[str]) -> str:
    """Write the first few of some names, and how many more there are."""
    more = len(names) - SHOWN
    return ", ".join(names[:SHOWN]) + (f" and {more} more" if more > 0 else "")


def spanned(first: int, last: int) -> str:
    """Write the frames of a gap."""
    return str(first) if first == last else f"{first} to {last}"
