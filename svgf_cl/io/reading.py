"""`Reading`: turns the files of a shot into frames, in the way that its first file and the user's options determine."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

import numpy as np
import numpy.typing as npt

from svgf_cl.camera import Camera
from svgf_cl.errors import FileError, FrameError, SvgfError
from svgf_cl.frame import CHANNELS, REQUIRED, Frame
from svgf_cl.io.derived import derived
from svgf_cl.io.image import Image
from svgf_cl.io.look_alikes import advice, grouped
from svgf_cl.io.readers import reader_called, reader_of
from svgf_cl.io.readers.conversions import Array, without_edges
from svgf_cl.io.readers.own import CHANNEL_NAMES, OWN, needed
from svgf_cl.io.readers.passes import by_view_layer, called, place, plain
from svgf_cl.io.readers.reader import HELPERS, Found, LightPasses, Pass, Reader, Source, Values

# Least number of components of each field.
SIZES = {field: max(1, min(sizes)) for field, sizes in CHANNELS.items()} | HELPERS

CAMERAS = "give the camera of each frame in cameras.json beside the frames, or with --cameras FILE"
STILL = "if neither the camera nor any object moves, give --still-camera"


@dataclass(frozen=True)
class ReadAs:
    """The user's options for reading files, which add to the files' own information or replace it.

    Parameters
    ----------
    format : str, optional
        The name of a reader; by default the first file decides.
    view_layer : str, optional
        The view layer to read, if a file has several.
    passes : mapping of str to str
        The pass or channel for a field, or for one of `HELPERS`.
    motion_scale : (float, float)
        Factors for x and y of motion; -1 reverses an axis.
    cameras : mapping of int to Camera, or Path
        The camera of each frame, by the frame's number, or a file of cameras; by default they come from the files'
        headers.
    still_camera : bool
        Set all motion to 0 if files have none and it cannot be computed.
    """

    format: str | None = None
    view_layer: str | None = None
    passes: Mapping[str, str] = field(default_factory=dict)
    motion_scale: tuple[float, float] = (1.0, 1.0)
    cameras: Mapping[int, Camera] | Path = field(default_factory=dict)
    still_camera: bool = False

    def __post_init__(self) -> None:
        for name in self.passes:
            if name not in SIZES:
                raise SvgfError(f"--map: expected one of {', '.join(SIZES)}, got {name!r}")


@dataclass(frozen=True)
class LightPass:
    """A pass of a file that is a part of its picture.

    Parameters
    ----------
    channels : tuple of str
        Its red, green and blue channel.
    factor : tuple of str
        The channels of the pass to multiply it by; empty if it needs no factor.
    kind : readers.reader.LightPasses
        The reader's description of it.
    """

    channels: tuple[str, ...]
    factor: tuple[str, ...]
    kind: LightPasses

    @property
    def filtered(self) -> bool:
        """Whether it is noisy."""
        return self.kind.filtered


class Reading:
    """Turns the files of a shot into frames.

    Parameters
    ----------
    path : Path
        The first file, for errors.
    image : Image
        Its content.
    how : ReadAs
    separate : mapping of str to tuple of str
        Channels of fields that come from other files.

    Raises
    ------
    FileError
        If the file lacks the view layer, has several and none was chosen, or lacks a pass or channel of ``--map``.
    """

    def __init__(
        self, path: Path, image: Image, how: ReadAs, separate: Mapping[str, tuple[str, ...]] | None = None
    ) -> None:
        self.how = how
        self.reader: Reader = reader_called(how.format) if how.format else reader_of(image)
        self._layers = by_view_layer(image.planes)
        self._channels = tuple(image.planes)
        self.view_layer = self._chosen_layer(path)
        try:
            self.sources = self.reader.sources(self._found) | self._mapped(separate or {})
        except ValueError as error:
            raise FileError(f"{path}: {error}") from error

    def frame(
        self, path: Path, planes: Mapping[str, Array], camera: Camera | None = None, previous: Camera | None = None
    ) -> Frame:
        """Make the frame of a file.

        Parameters
        ----------
        path : Path
        planes : mapping of str to (H, W) array
            Its channels.
        camera, previous : Camera, optional
            The cameras of this frame and of the previous one, to compute motion and depth if the file lacks them.

        Raises
        ------
        FileError
            If a field is missing or invalid.
        """
        values = self.values(path, planes)
        if self.reader.complete:
            values = self.reader.complete(values, camera)
        values |= derived(values, camera, previous, still=self.how.still_camera)
        if "emission" not in values and (shining := [light for light in self.lights if not light.filtered]):
            values["emission"] = sum_of(self.radiance(path, planes, light) for light in shining)
        missing = [name for name in REQUIRED if name not in values]
        if not values.keys() & {"color", "direct", "indirect"}:
            missing = ["color", *missing]
        if missing:
            raise self._absent(path, missing, planes)
        try:
            frame = Frame(**{name: value for name, value in values.items() if name in CHANNELS})
            frame.check_presence()
        except FrameError as error:
            raise FileError(f"{path}: {error}; channels found: {' '.join(planes)}") from error
        return frame

    def motion_to_next(self, path: Path, planes: Mapping[str, Array]) -> npt.NDArray[np.float32] | None:
        """Return the motion to the next frame, (H, W, 2), if the file has it."""
        if "motion_to_next" not in self.sources:
            return None
        return np.asarray(self._value(path, planes, "motion_to_next"), np.float32)

    def values(self, path: Path, planes: Mapping[str, Array]) -> Values:
        """Return the values of a file's passes; errors as in `frame`."""
        there = [name for name, (_, channels) in self.sources.items() if planes.keys() & set(channels)]
        return {name: self._value(path, planes, name) for name in there if name != "motion_to_next"}

    def _value(self, path: Path, planes: Mapping[str, Array], name: str) -> Array:
        source, channels = self.sources[name]
        lost = [channel for channel in channels if channel not in planes]
        if lost:
            raise self._absent(path, [name], planes)
        try:
            value = source.read([single_precision(planes[channel]) for channel in channels])
        except ValueError as error:
            raise FileError(f"{path}: {error}") from error
        if name in ("motion", "motion_to_next"):
            scale = np.ones(value.shape[-1], np.float32)
            scale[:2] = self.how.motion_scale
            return np.asarray(value * scale if (scale != 1).any() else value, np.float32)
        return value if name == "id" else np.asarray(value, np.float32)

    @cached_property
    def picture(self) -> tuple[str, ...]:
        """The channels of the picture; ``R G B`` if the file has only parts of its light."""
        return self.sources["color"][1][:3] if "color" in self.sources else CHANNEL_NAMES["color"]

    @cached_property
    def lights(self) -> tuple[LightPass, ...]:
        """The passes whose sum is the picture, as far as the file has them; empty if none of them is noisy."""
        passes, found = self._layers.get(self.view_layer, {}), []
        for light in self.reader.lights:
            factor = passes.get(plain(light.factor), ()) if light.factor else ()
            if light.factor and len(factor) < 3:
                continue
            there = [passes[name] for name in map(plain, light.names) if len(passes.get(name, ())) >= 3]
            found += [LightPass(channels[:3], factor[:3], light) for channels in there]
        return tuple(found) if any(light.filtered for light in found) else ()

    def radiance(self, path: Path, planes: Mapping[str, Array], light: LightPass) -> npt.NDArray[np.float32]:
        """Return a light pass, (H, W, 3), without its factor, where it is in the picture; errors as in `frame`."""
        radiance = stacked(path, planes, light.channels)
        if light.kind.is_background and self.alpha in planes:
            radiance *= np.asarray(planes[self.alpha] >= 1.0)[..., None]
        return radiance

    @cached_property
    def alpha(self) -> str:
        """The channel of the picture's alpha; empty if there is none."""
        layer, name, _ = place(self.picture[0])
        channels = self._layers.get(layer, {}).get(name, ())
        return channels[3] if len(channels) > 3 else ""

    @property
    def _found(self) -> Found:
        return Found(self._channels, self._layers.get(self.view_layer, {}))

    def _chosen_layer(self, path: Path) -> str:
        """Return the name of the view layer to read."""
        wanted, layers = self.how.view_layer, self._possible_layers()
        if wanted is not None:
            if wanted not in self._layers:
                raise FileError(f"{path}: expected a view layer {wanted!r}, found {', '.join(layers) or 'none'}")
            return wanted
        if len(layers) > 1:
            raise FileError(f"{path}: expected one view layer, found {', '.join(layers)}; choose with --view-layer")
        return layers[0] if layers else ""

    def _possible_layers(self) -> list[str]:
        """Return the view layers that have a picture and other fields, or else a picture, or else any field."""
        found = {name: self.reader.sources(Found((), passes)).keys() for name, passes in self._layers.items()}
        with_picture = [name for name, fields in found.items() if "color" in fields]
        with_more = [name for name in with_picture if len(found[name]) > 1]
        return with_more or with_picture or [name for name, fields in found.items() if fields]

    def _mapped(self, separate: Mapping[str, tuple[str, ...]]) -> dict[str, tuple[Source, tuple[str, ...]]]:
        """Return the sources that the user names; they are converted like the renderer's own passes."""
        found: dict[str, tuple[Source, tuple[str, ...]]] = {}
        mapped = {name: called(wanted, self._channels, self.view_layer) for name, wanted in self.how.passes.items()}
        for name, channels in {**mapped, **separate}.items():
            size, where = SIZES[name], self.how.passes.get(name, "its file")
            if not channels:
                raise ValueError(f"expected a pass or channel {where} for {name}, found {grouped(self._channels)}")
            if len(channels) < size:
                raise ValueError(f"expected {size} components of {name} in {where}, found {len(channels)}")
            usual = [source for source in self.reader.passes.get(name, ()) if source.size <= len(channels)]
            convert = usual[0].convert if usual else without_edges if name == "id" else None
            source = Pass((name,), usual[0].size if usual else size, convert)
            found[name] = source, source.used(channels)
        return found

    def _absent(self, path: Path, fields: list[str], planes: Mapping[str, Array]) -> FileError:
        """Return the error for missing fields; it lists the file's channels, and says what to do in the renderer."""
        switches = self.reader.switches
        measured = {"depth", "position", "distance"} & self.sources.keys()  # with a camera, one of these gives motion
        written = [field for field in fields if field in self.reader.passes or not measured]
        if {*REQUIRED} <= {*fields}:  # there is only the picture: the file's format may allow no more
            written = ["color", *written]
        hints = [switches[field] for field in written if field in switches]
        hints += [CAMERAS] if measured and {"depth", "motion"} & set(fields) else []
        unknown = {field: needed(field) for field in fields if self.reader is OWN and field in CHANNEL_NAMES}
        hints += [text] if (text := advice(planes, unknown)) else []
        hints += [STILL] if "motion" in fields and "depth" not in fields else []
        wanted = " ".join(name for names in unknown.values() for name in names)
        expected = f"channels {wanted}" if unknown else f"{', '.join(fields)} in a file of {self.reader.title}"
        return FileError("; ".join([f"{path}: expected {expected}, found {grouped(planes)}", *dict.fromkeys(hints)]))


def stacked(path: Path, planes: Mapping[str, Array], channels: Sequence[str]) -> npt.NDArray[np.float32]:
    """Return the picture (H, W, 3) of three channels; raise `FileError` if the file lacks one."""
    lost = [channel for channel in channels if channel not in planes]
    if lost:
        raise FileError(f"{path}: expected the light pass {grouped(channels)} as in the first frame, found none")
    return np.stack([np.asarray(planes[channel], np.float32) for channel in channels], axis=-1)


def single_precision(plane: Array) -> Array:
    """Return a plane of floats as float32, and a plane of integers unchanged."""
    return plane if plane.dtype.kind in "ui" else np.asarray(plane, np.float32)


def sum_of(pictures: Iterable[Array]) -> npt.NDArray[np.float32]:
    """Return the sum of pictures (H, W, 3)."""
    total: npt.NDArray[np.float32] = np.sum(list(pictures), axis=0, dtype=np.float32)
    return total
