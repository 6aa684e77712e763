"""Footage from files: a user's frames with references, or pictures with references alone."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from svgf_cl.compare.halves import Pair
from svgf_cl.errors import FileError
from svgf_cl.frame import Frame, Shape, extent
from svgf_cl.io.atomic import require
from svgf_cl.io.display import Linear
from svgf_cl.io.pictures import read_picture
from svgf_cl.io.sequence import find_numbered, frame_number
from svgf_cl.io.shot import read_shot, shared_window

NO_NUMBER = 0  # of the frame of a file that has none in its name


@dataclass(frozen=True)
class Recorded:
    """Frames of any renderer, and references of some of them.

    Parameters
    ----------
    paths : mapping of int to Path
        The frames' files by number.
    references : mapping of int to Path
        Those of the references; each has its frame.
    jitter : bool
        Whether the renderer moved its rays within the pixel: filters then antialias over time.
    """

    paths: Mapping[int, Path]
    references: Mapping[int, Path]
    jitter: bool

    @property
    def note(self) -> str:
        """What there is to know of the figures."""
        rays = "antialiased over time" if self.jitter else "not antialiased"
        return f"{rays}; one reference a frame, whose own noise counts as error"

    @property
    def name(self) -> str:
        """The folder's, or that of the only file."""
        first = next(iter(self.paths.values()))
        return first.parent.resolve().name if len(self.paths) > 1 else first.stem

    @property
    def numbers(self) -> Sequence[int]:
        """In order."""
        return sorted(self.paths)

    @property
    def judged(self) -> Sequence[int]:
        """In order."""
        return sorted(self.references)

    @property
    def steps(self) -> int:
        """One a reference."""
        return len(self.references)

    @property
    def identity(self) -> str:
        """Names, sizes and times of all files."""
        files = [*self.paths.values(), *self.references.values()]
        return " ".join(f"{path.resolve()}:{path.stat().st_size}:{path.stat().st_mtime_ns}" for path in files)

    @cached_property
    def shape(self) -> Shape:
        """Of the first reference."""
        height, width, _ = read_picture(self.references[self.judged[0]]).shape
        return height, width

    def frames(self) -> Iterator[Frame]:
        """Frames as `svgf-cl denoise` reads them, on the window that all share."""
        paths = [self.paths[number] for number in self.numbers]
        for path, (_, frame) in zip(paths, read_shot(paths, shared_window(paths)), strict=True):
            check_size(path, frame.shape, self.shape)
            yield frame

    def truths(self, advance: Callable[[], None]) -> Mapping[int, Pair]:
        """Read the references; the two halves of a pair are the same."""
        found = {}
        for number in self.judged:
            picture = read_picture(self.references[number])
            check_size(self.references[number], picture.shape[:2], self.shape)
            found[number] = (picture, picture)
            advance()
        return found


@dataclass(frozen=True)
class Pictures(Recorded):
    """Pictures and references without any G-buffer: frames that show nothing but their colour."""

    def frames(self) -> Iterator[Frame]:
        """The pictures, as frames that hit nothing."""
        for number in self.numbers:
            picture = read_picture(self.paths[number])
            check_size(self.paths[number], picture.shape[:2], self.shape)
            yield bare_frame(picture)


def bare_frame(picture: Linear) -> Frame:
    """A frame of which nothing is known but its colour (H, W, 3)."""
    shape = picture.shape[:2]
    nothing = np.zeros((*shape, 3), np.float32)
    depth = np.full(shape, np.inf, np.float32)
    return Frame(color=np.asarray(picture, np.float32), normal=nothing, depth=depth, motion=nothing)


def check_size(path: Path, have: Shape, want: Shape) -> None:
    """Raise `FileError` where a file is not of the size of the references."""
    if have != want:
        raise FileError(f"{path}: expected {extent(want)} pixels as in the references, got {extent(have)}")


def by_number(place: Path, stem: str) -> dict[int, Path]:
    """The pictures of a folder by number, or the only one where `place` is a file; those called `stem` if any are.

    Raises
    ------
    FileError
        Where there is nothing, or no sequence.
    """
    require(place)
    if not place.is_dir():
        return {NO_NUMBER: place}
    return {frame_number(path) or 0: path for path in find_numbered(place, stem)}


def paired(a: Path, b: Path) -> tuple[dict[int, Path], dict[int, Path]]:
    """Pictures and references by number; of a folder's pictures those with no reference too.

    Raises
    ------
    FileError
        Where one is a file and the other a folder, or a reference has no picture.
    """
    pictures, references = by_number(a, "frame"), by_number(b, "reference")
    if a.is_dir() != b.is_dir():
        raise FileError(f"expected two files or two folders, got {a} and {b}")
    for number, path in references.items():
        if number not in pictures:
            raise FileError(f"{a}: expected a picture number {number} to compare with {path}, found none")
    return pictures, references
