"""Fields in separate files, one file for each field and frame, as ``--albedo albedo.####.exr`` gives them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from svgf_cl.errors import FileError, SvgfError, shown
from svgf_cl.frame import CHANNELS
from svgf_cl.io.exr import read_image
from svgf_cl.io.image import Image, Plane
from svgf_cl.io.look_alikes import grouped
from svgf_cl.io.readers.passes import PLACES, by_view_layer
from svgf_cl.io.readers.reader import HELPERS
from svgf_cl.io.sequence import find_frames, number_of
from svgf_cl.io.window import Window

# Without color: the picture is in the frame's own file.
FIELDS = tuple(name for name in CHANNELS | HELPERS if name not in ("color", "motion_to_next"))


@dataclass(frozen=True)
class SeparateFiles:
    """The files of some fields, by the numbers of their frames.

    Parameters
    ----------
    paths : mapping of str to (mapping of int to Path)
        The files of each field.
    """

    paths: Mapping[str, Mapping[int, Path]]

    @classmethod
    def of(cls, patterns: Mapping[str, Path]) -> SeparateFiles:
        """Find the files of each field, which is given as a pattern, a folder or a file.

        Raises
        ------
        FileError
            As in `find_frames`.
        SvgfError
            If there is no field of that name.
        """
        for field in patterns:
            if field not in FIELDS:
                raise SvgfError(f"separate: expected one of {', '.join(FIELDS)}, got {shown(field)}")
        return cls(
            {
                field: {number_of(path): path for path in find_frames([pattern], allow_gaps=True)}
                for field, pattern in patterns.items()
            }
        )

    def require(self, numbers: Sequence[int]) -> None:
        """Raise `FileError` unless each of these frames has a file for every field."""
        for field, files in self.paths.items():
            missing = [number for number in numbers if number not in files]
            if missing:
                example = next(iter(files.values()))
                raise FileError(f"{example}: expected a file of {field} for frame {missing[0]}, found none")

    def channels(self, number: int) -> dict[str, tuple[str, ...]]:
        """Return the channels of each field, with the names of `planes`, from the files of one frame."""
        return {field: tuple(self._planes(field, number)) for field in self.paths}

    def planes(self, number: int, window: Window) -> dict[str, Plane]:
        """Return the channels of all fields of a frame that has this data window.

        Raises
        ------
        FileError
            If a field's file has no pass, several passes, or another data window.
        """
        return {name: plane for field in self.paths for name, plane in self._planes(field, number, window).items()}

    def _planes(self, field: str, number: int, window: Window | None = None) -> dict[str, Plane]:
        path = self.paths[field][number]
        image = read_image(path)
        if window not in (None, image.windows.data):
            raise FileError(f"{path}: expected the data window {window} of its frame, got {image.windows.data}")
        return {f"{field} {index}": image.planes[name] for index, name in enumerate(pass_of(path, image))}


def pass_of(path: Path, image: Image) -> Sequence[str]:
    """Return the channels of a file's only pass, which may have no name, or of its picture."""
    places = {PLACES[name.casefold()]: name for name in image.planes if name.casefold() in PLACES}
    if len(places) == len(image.planes):
        return [places[place] for place in sorted(places)]
    passes = [(name, channels) for layer in by_view_layer(image.planes).values() for name, channels in layer.items()]
    pictures = [channels for name, channels in passes if not name]
    if len(passes) != 1 and len(pictures) != 1:
        raise FileError(f"{path}: expected one pass, or R G B, found {grouped(image.planes)}")
    return pictures[0] if pictures else passes[0][1]
