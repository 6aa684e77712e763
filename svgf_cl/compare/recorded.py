"""Footage from files: a user's frames with references, or pictures with references alone."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np

from svgf_cl.compare.halves import Pair
from svgf_cl.compare.metrics import SSIM_WINDOW
from svgf_cl.errors import FileError
from svgf_cl.frame import Frame, Shape, extent
from svgf_cl.io.atomic import require
from svgf_cl.io.display import Linear
from svgf_cl.io.exr import read_windows
from svgf_cl.io.pictures import read_picture
from svgf_cl.io.sequence import after_gaps, find_frames, find_numbered, frame_number, number_of
from svgf_cl.io.shot import Shot, moved


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
        """Names, sizes and times of all files, and what is known of their rays."""
        files = [*self.paths.values(), *self.references.values()]
        stamps = [f"{path.resolve()}:{path.stat().st_size}:{path.stat().st_mtime_ns}" for path in files]
        return " ".join((*stamps, f"jitter={self.jitter}"))

    @cached_property
    def shape(self) -> Shape:
        """Of the first reference; `FileError` where it is too small to be measured."""
        path = self.references[self.judged[0]]
        height, width, _ = read_picture(path).shape
        if min(height, width) < SSIM_WINDOW:
            least = extent((SSIM_WINDOW, SSIM_WINDOW))
            raise FileError(
                f"{path}: expected at least {least} pixels, which SSIM needs, got {extent((height, width))}"
            )
        return height, width

    def frames(self) -> Iterator[Frame]:
        """Frames as `svgf-cl denoise` reads them, on their display window: that is where references show something."""
        paths = [self.paths[number] for number in self.numbers]
        shot = Shot(paths)
        display = read_windows(paths[0]).display
        for path, frame in zip(paths, shot, strict=True):
            shown = moved(frame, shot.window, display)
            check_size(path, shown.shape, self.shape)
            yield with_color(shown)

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


def open_frames(frames: Sequence[Path], reference: Path, *, jitter: bool) -> Recorded:
    """Frames, files or their folder, and a picture or a folder of them that says what some converge to.

    Raises
    ------
    FileError
        Where they are no sequence without gaps, or a reference has no frame.
    """
    files = find_frames(frames, allow_gaps=True)
    for path in sorted(after_gaps(files)):
        raise FileError(f"{path}: expected the previous frame, which filters need, found none")
    paths = {number_of(path): path for path in files}
    return Recorded(paths, find_references(reference, list(paths)), jitter)


def find_references(reference: Path, numbers: Sequence[int]) -> dict[int, Path]:
    """The files that say what some frames converge to, by the frames' numbers: a picture, or those of a folder.

    Raises
    ------
    FileError
        Where one has no frame among `numbers`.
    """
    require(reference)
    if reference.is_dir():
        references = by_number(reference, "reference")
    elif len(numbers) == 1:
        references = dict.fromkeys(numbers, reference)
    elif frame_number(reference) is None:
        raise FileError(f"{reference}: expected in its name the number of one of the {len(numbers)} frames, found none")
    else:
        references = {number_of(reference): reference}
    for number, path in references.items():
        if number not in numbers:
            raise FileError(f"{path}: expected a frame number {number} among the frames, found none")
    return references


def open_pictures(pictures: Path, references: Path) -> Pictures:
    """Two pictures; or two folders, paired by number: pictures without a reference are left out.

    Raises
    ------
    FileError
        Where one is a file and the other a folder, one holds no sequence, or a reference has no picture.
    """
    require(pictures)
    require(references)
    if pictures.is_dir() != references.is_dir():
        raise FileError(f"expected two files or two folders, got {pictures} and {references}")
    if not pictures.is_dir():
        number = number_of(pictures)
        return Pictures({number: pictures}, {number: references}, jitter=True)
    tested, wanted = by_number(pictures, "frame"), by_number(references, "reference")
    for number, path in wanted.items():
        if number not in tested:
            raise FileError(f"{pictures}: expected a picture number {number} to compare with {path}, found none")
    return Pictures({number: tested[number] for number in wanted}, wanted, jitter=True)


def by_number(folder: Path, stem: str) -> dict[int, Path]:
    """The pictures of a folder by number, those called `stem` if any are; `FileError` where there is no sequence."""
    return {number_of(path): path for path in find_numbered(folder, stem)}


def with_color(frame: Frame) -> Frame:
    """The same frame with a colour, which may be given as two signals only."""
    if frame.color is not None:
        return frame
    emission = 0.0 if frame.emission is None else frame.emission
    return replace(frame, color=np.asarray(frame.direct + frame.indirect + emission, np.float32))


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
