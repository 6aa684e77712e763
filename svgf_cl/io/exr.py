"""OpenEXR files: written whole or not at all; read, as Radiance HDR is, not trusting their claims."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO as oiio  # noqa: N813  # its documentation calls it so

from svgf_cl.errors import FileError, one_line
from svgf_cl.io.atomic import require, unreadable, written_whole
from svgf_cl.io.exr_header import Attributes, copy_with_header, encoded, read_attributes
from svgf_cl.io.image import Image, Part, Plane, Windows, new_image
from svgf_cl.io.layers import unique_names
from svgf_cl.io.window import Window

# A file that claims more bytes of pixels than these is refused, unless it is so large that they can be in it: no method
# of compression in use makes much less of a picture than zlib's best, one byte of 1032.
TRUSTED = 2**30
MAX_RATIO = 1032

# Pixels of a display window beyond those of the data window, which cost nothing to claim: 16384 x 16384.
MAX_DISPLAY = 2**28

# Formats that hold linear light, by OpenImageIO's names for them.
FORMATS = {"openexr": "an OpenEXR file", "hdr": "a Radiance HDR file"}


def write_channels(path: Path, planes: Mapping[str, Plane], attributes: Mapping[str, int | float | str] = {}) -> None:
    """Write (H, W) planes as the channels of one EXR file with such attributes, whole or not at all.

    Raises
    ------
    FileError
        The file cannot be written; whatever was at `path` before is still there.
    """
    write_image(path, new_image(planes, {name: encoded(value) for name, value in attributes.items()}))


def write_image(path: Path, image: Image) -> None:
    """Write an EXR file of these parts, channels, windows and attributes, zip compression; errors of `write_channels`.

    The same image makes the same file: there is no date in it but one among the attributes.
    """
    with written_whole(path) as aside:
        pixels = aside.with_name(f".pixels{aside.name}")
        integers = [{_stored(part, name) for name in part.planes if _is_integer(part, name)} for part in image.parts]
        try:
            _write_pixels(path, pixels, image)
            copy_with_header(pixels, aside, [part.attributes for part in image.parts], integers)
            if not _has_last_rows(aside):
                raise FileError(f"{path}: cannot be written (one of the attributes that it would keep is damaged)")
        finally:
            pixels.unlink(missing_ok=True)


def _write_pixels(path: Path, target: Path, image: Image) -> None:
    """Write to `target` what will be made the file at `path`: its pixels, integers as floats of the same bits."""
    specs = [_spec(image.windows, part) for part in image.parts]
    output: Any = oiio.ImageOutput.create("openexr")
    if len(specs) > 1:
        for index, spec in enumerate(specs):
            spec.attribute("oiio:subimagename", str(index))  # two of one name would not be written
        done = output.open(_name(target), specs)
    else:
        done = output.open(_name(target), specs[0])
    for index, (spec, part) in enumerate(zip(specs, image.parts, strict=True)):
        pixels = np.stack([plane.view(np.float32) for plane in part.planes.values()], axis=-1)
        done = done and (not index or output.open(_name(target), spec, "AppendSubimage")) and output.write_image(pixels)
    complaint = one_line(output.geterror())
    if not (output.close() and done):
        raise FileError(f"{path}: cannot be written ({complaint}); is there room on the disk?")
    if not _has_last_rows(target):
        raise FileError(f"{path}: cannot be written (its end is missing); is there room on the disk?")


def _spec(windows: Windows, part: Part) -> oiio.ImageSpec:
    """What OpenImageIO must know to write the pixels of a part."""
    types = ["half" if channel in part.halves else "float" for channel in part.planes]
    spec = oiio.ImageSpec(windows.data.width, windows.data.height, len(part.planes), types[0])
    spec.x, spec.y, _, _ = windows.data
    spec.channelnames = tuple(_stored(part, channel) for channel in part.planes)
    if len(set(types)) > 1:
        spec.channelformats = tuple(types)
    spec.attribute("compression", "zip")
    spec.attribute("DateTime", "")  # or there would be one
    return spec


def _stored(part: Part, channel: str) -> str:
    """The name of a channel in the file."""
    return part.stored.get(channel, channel)


def _is_integer(part: Part, channel: str) -> bool:
    """Whether a channel holds unsigned integers."""
    return part.planes[channel].dtype == np.uint32


def read_channels(path: Path) -> dict[str, Plane]:
    """Read every channel of an EXR file as a (H, W) plane, float32 or uint32, by the names of `read_image`.

    Raises
    ------
    FileError
        As of `read_image`.
    """
    return read_image(path).planes


def read_attribute(path: Path, name: str) -> object:
    """The attribute of an EXR file called `name`; None where there is none; errors as of `read_image`."""
    with _opened(path, ("openexr",)) as (_, specs):
        return specs[0].get(name)


def read_windows(path: Path) -> Windows:
    """Read where the pixels of an EXR file lie; errors as of `read_image`."""
    with _opened(path, ("openexr",)) as (_, specs):
        return _windows(specs[0])


def read_image(path: Path, formats: Collection[str] = ("openexr",)) -> Image:
    """Read all of a file, every part of it.

    A channel goes by its name in the file; where several parts have that name, `unique_names` says by which. Of tiles
    in several resolutions the finest is read.

    Parameters
    ----------
    path : Path
    formats : collection of str
        Those accepted, out of `FORMATS`.

    Raises
    ------
    FileError
        The file is missing, of another format or damaged, or claims more pixels than it can hold, or what it holds is
        of a kind that is not read: deep pixels, several views, channels with fewer pixels than others, parts with
        pixels in different places.
    """
    with _opened(path, formats) as (source, specs):
        try:
            is_exr = source.format_name() == "openexr"
            attributes: list[Attributes] = read_attributes(path) if is_exr else [{}]
            if len(attributes) != len(specs):
                raise ValueError(f"expected a whole image, got a damaged one ({len(attributes)} parts or {len(specs)})")
            names = unique_names([(spec.get("oiio:subimagename", ""), spec.channelnames) for spec in specs])
        except OSError as error:
            raise unreadable(path, error) from error
        except UnicodeError:
            raise
        except ValueError as error:
            raise FileError(f"{path}: {error}") from error
        parts = []
        for index, (spec, own, called) in enumerate(zip(specs, attributes, names, strict=True)):
            pixels = _pixels(path, source, index, spec)
            planes = {called[name]: pixels[name] for name in pixels}
            halves = {called[name] for name in pixels if _format(spec, name) == oiio.HALF}
            stored = {called[name]: name for name in pixels if called[name] != name}
            parts.append(Part(planes, own, frozenset(halves), stored))
        return Image(_windows(specs[0]), tuple(parts))


def _pixels(path: Path, source: Any, index: int, spec: oiio.ImageSpec) -> dict[str, Plane]:
    """The channels of a part, by their names in the file."""
    pixels = source.read_image(index, 0, 0, spec.nchannels, "float")
    if pixels is None:
        raise FileError(f"{path}: expected a whole image, got a damaged one ({one_line(source.geterror())})")
    planes: dict[str, Plane] = {}
    for channel, name in enumerate(spec.channelnames):
        planes[name] = np.ascontiguousarray(pixels[..., channel])
        # As floats, integers have come as fractions of the largest one.
        if _format(spec, name) == oiio.UINT32:
            integers = source.read_image(index, 0, channel, channel + 1, oiio.UINT32)
            planes[name] = np.ascontiguousarray(integers[..., 0])
    return planes


def _format(spec: oiio.ImageSpec, name: str) -> Any:
    """The pixel type of a channel."""
    return spec.channelformat(spec.channelindex(name)).basetype


def _windows(spec: oiio.ImageSpec) -> Windows:
    """Where the pixels of a part lie."""
    data = Window(spec.x, spec.y, spec.width, spec.height)
    display = Window(spec.full_x, spec.full_y, spec.full_width, spec.full_height)
    return Windows(data, display, spec.get_float_attribute("PixelAspectRatio", 1.0))


@contextmanager
def _opened(path: Path, formats: Collection[str]) -> Iterator[tuple[Any, list[oiio.ImageSpec]]]:
    """Open the file at `path`, whose header claims what can be read; all that is wrong is a FileError.

    Yields the open file and what it says of each part.
    """
    require(path)
    if not path.is_file():  # but a folder; or a pipe, which might keep us waiting for ever
        raise FileError(f"{path}: expected {_described(formats)}, found something that is no file")
    try:
        source = oiio.ImageInput.open(_name(path))
        if source is None or source.format_name() not in formats:
            got = f"the format {source.format_name()}" if source else one_line(oiio.geterror())
            raise FileError(f"{path}: expected {_described(formats)}, got {got}")
        specs = _specs(source)
        "".join(name for spec in specs for name in spec.channelnames).encode()
        _check_claims(path, specs)
        _check_kind(path, specs)
        yield source, specs
    except UnicodeError as error:
        raise FileError(f"{path}: expected text in UTF-8 in its header, got another ({error})") from error
    except MemoryError as error:
        raise FileError(f"{path}: expected an image that fits into memory, got a larger one") from error


def _specs(source: Any) -> list[oiio.ImageSpec]:
    """What an open file says of each of its parts."""
    specs: list[oiio.ImageSpec] = []
    while source.seek_subimage(len(specs), 0):
        specs.append(oiio.ImageSpec(source.spec()))
    return specs


def _check_claims(path: Path, specs: Sequence[oiio.ImageSpec]) -> None:
    """Raise `FileError` where a file claims more pixels than it can hold, or a picture that no memory can."""
    claimed, held = sum(spec.image_bytes() for spec in specs), path.stat().st_size
    if claimed > max(TRUSTED, MAX_RATIO * held):
        raise FileError(f"{path}: expected a whole image, got {claimed} bytes of pixels in a file of {held}")
    windows = _windows(specs[0])
    if windows.display.area > max(MAX_DISPLAY, windows.data.area):
        raise FileError(f"{path}: expected a display window of at most {MAX_DISPLAY} pixels, got {windows.display}")


def _check_kind(path: Path, specs: Sequence[oiio.ImageSpec]) -> None:
    """Raise `FileError` where a file is of a kind that is not read."""
    views = {view for spec in specs for view in _views(spec)}
    if any(spec.deep for spec in specs):
        raise FileError(f"{path}: expected flat pixels, got deep ones; flatten the image first")
    if len(views) > 1:
        raise FileError(f"{path}: expected one view, got {', '.join(sorted(views))}; write each to a file of its own")
    for spec in specs:
        if _windows(spec) != _windows(specs[0]):
            raise FileError(
                f"{path}: expected all parts to have the windows of the first, {_described_windows(specs[0])}, got"
                f" {_described_windows(spec)} in part {spec.get('oiio:subimagename')}"
            )


def _views(spec: oiio.ImageSpec) -> list[str]:
    """The views that a part says it has, such as left and right."""
    listed = spec.get("multiView")
    named = [spec.get("view"), *(listed if isinstance(listed, tuple) else ())]
    return [view for view in named if isinstance(view, str) and view]


def _described_windows(spec: oiio.ImageSpec) -> str:
    """Where the pixels of a part lie, in words."""
    windows = _windows(spec)
    return f"{windows.data} of {windows.display}"


def _has_last_rows(path: Path) -> bool:
    """Whether the end of a file has been written: of a disk that is full by then OpenImageIO says nothing."""
    source: Any = oiio.ImageInput.open(_name(path))
    if source is None:
        oiio.geterror()  # or it is printed as the process ends
        return False
    return all(
        source.read_scanlines(index, 0, spec.y + spec.height - 1, spec.y + spec.height, 0, 0, 1, "float") is not None
        for index, spec in enumerate(_specs(source))
    )


def _described(formats: Collection[str]) -> str:
    """What a file of one of these formats is called in errors."""
    return " or ".join(FORMATS[name] for name in formats)


def _name(path: Path) -> str:
    """`path` as OpenImageIO takes it."""
    try:
        return path.as_posix().encode().decode()
    except UnicodeEncodeError as error:
        raise FileError(f"{str(path)!a}: expected a name in UTF-8; rename it or its folder") from error
