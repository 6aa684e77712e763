"""Footage from files: a user's frames with references, or only pictures with references."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
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
from svgf_cl.io.reading import ReadAs
from svgf_cl.io.sequence import after_gaps, find_frames, find_numbered, frame_number, number_of
from svgf_cl.io.shot import Shot, moved


@dataclass(frozen=True)
class Recorded:
    """Frames of any renderer, and references for some of them.

    Parameters
    ----------
    paths : mapping of int to Path
        The frames' files by number.
    references : mapping of int to Path
        The references' files by number; each number is also in `paths`.
    jitter : bool
        Whether the renderer moved its rays within the pixel; filters then antialias over time.
    how : ReadAs
        How to read the frames.
    """

    paths: Mapping[int, Path]
    references: Mapping[int, Path]
    jitter: bool
    how: ReadAs = field(default_factory=ReadAs)

    @property
    def note(self) -> str:
        """A remark on the values."""
        rays = "antialiased over time" if self.jitter else "not antialiased"
        return f"{rays}; one reference a frame, whose own noise counts as error"

    @property
    def name(self) -> str:
        """The folder's name, or the file's if there is only one."""
        first = next(iter(self.paths.values()))
        return first.parent.resolve().name if len(self.paths) > 1 else first.stem

    @property
    def numbers(self) -> Sequence[int]:
        """The numbers of all frames, in order."""
        return sorted(self.paths)

    @property
    def judged(self) -> Sequence[int]:
        """The numbers of the frames with a reference, in order."""
        return sorted(self.references)

    @property
    def steps(self) -> int:
        """One step for each reference."""
        return len(self.references)

    @property
    def identity(self) -> str:
        """Names, sizes and times of all files, how frames are read, and `jitter`."""
        files = [*self.paths.values(), *self.references.values()]
        if isinstance(self.how.cameras, Path):
            files.append(self.how.cameras)
        stamps = [f"{path.resolve()}:{path.stat().st_size}:{path.stat().st_mtime_ns}" for path in files]
        return " ".join((*stamps, f"jitter={self.jitter}", repr(self.how)))

    @cached_property
    def shape(self) -> Shape:
        """The first reference's (height, width); raises `FileError` if it is too small for SSIM."""
        path = self.references[self.judged[0]]
        height, width, _ = read_picture(path).shape
        if min(height, width) < SSIM_WINDOW:
            least = extent((SSIM_WINDOW, SSIM_WINDOW))
            raise FileError(
                f"{path}: expected at least {least} pixels, which SSIM needs, got {extent((height, width))}"
            )
        return height, width

    def frames(self) -> Iterator[Frame]:
        """Yield the frames as `svgf-cl denoise` reads them, cut to their display window, which references show."""
        paths = [self.paths[number] for number in self.numbers]
        shot = Shot(paths, self.how)
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
    """Pictures and references without a G-buffer: frames that contain only a colour."""

    def frames(self) -> Iterator[Frame]:
        """Yield the pictures as frames in which no ray hits a surface."""
        for number in self.numbers:
            picture = read_picture(self.paths[number])
            check_size(self.paths[number], picture.shape[:2], self.shape)
            yield bare_frame(picture)


def open_frames(frames: Sequence[Path], reference: Path, how: ReadAs, *, jitter: bool) -> Recorded:
    """Open frames (files or their folder) and their references (a picture or a folder of pictures).

    Raises
    ------
    FileError
        If the frames are no sequence without gaps, or a reference has no frame.
    """
    files = find_frames(frames, allow_gaps=True)
    for path in sorted(after_gaps(files)):
        raise FileError(f"{path}: expected the previous frame, which filters need, found none")
    paths = {number_of(path): path for path in files}
    return Recorded(paths, find_references(reference, list(paths)), jitter, how)


def find_references(reference: Path, numbers: Sequence[int]) -> dict[int, Path]:
    """Return the references' files by number: a single picture, or those of a folder.

    Raises
    ------
    FileError
        If a reference has no frame among `numbers`.
    """
    require(reference)
    if reference.is_dir():
        references = by_number(reference, "reference")
    elif len(numbers) == 1:
        references = dict.fromkeys(numbers, reference)
    elif frame_number(reference) is None:
        raise FileError(f"{reference}: expected the number of one of the {len(numbers)} frames in its name, found none")
    else:
        references = {number_of(reference): reference}
    for number, path in references.items():
        if number not in numbers:
            raise FileError(f"{path}: expected a frame number {number} among the frames, found none")
    return references


def open_pictures(pictures: Path, references: Path) -> Pictures:
    """Open two pictures, or two folders of pictures with the same numbers; pictures without a reference are left out.

    Raises
    ------
    FileError
        If one is a file and the other a folder, if a folder has no sequence, or if a reference has no picture.
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
    """Return the pictures of a folder by number, only those called `stem` if there are any.

    Raises
    ------
    FileError
        If the folder has no sequence.
    """
    return {number_of(path): path for path in find_numbered(folder, stem)}


def with_color(frame: Frame) -> Frame:
    """Return the frame with a colour, which is the sum of its two signals if it has no colour itself."""
    if frame.color is not None:
        return frame
    emission = 0.0 if frame.emission is None else frame.emission
    return replace(frame, color=np.asarray(frame.direct + frame.indirect + emission, np.float32))


def bare_frame(picture: Linear) -> Frame:
    """Return a frame that contains only a colour (H, W, 3)."""
    shape = picture.shape[:2]
    nothing = np.zeros((*shape, 3), np.float32)
    depth = np.full(shape, np.inf, np.float32)
    return Frame(color=np.asarray(picture, np.float32), normal=nothing, depth=depth, motion=nothing)


def check_size(path: Path, have: Shape, want: Shape) -> None:
    """Raise `FileError` if a file's size is not that of the references."""
    if have != want:
        raise FileError(f"{path}: expected {extent(want)} pixels as in the references, got {extent(have)}")
