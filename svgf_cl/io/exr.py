"""OpenEXR files as named planes: written whole or not at all; read, as Radiance HDR is, not trusting their claims."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import OpenImageIO as oiio  # noqa: N813  # its documentation calls it so

from svgf_cl.errors import FileError, one_line
from svgf_cl.io.atomic import require, written_whole

Plane = npt.NDArray[np.float32]

# A file that claims more bytes of pixels than these is refused, unless it is so large that they can be in it: no method
# of compression in use makes much less of a picture than zlib's best, one byte of 1032.
TRUSTED = 2**30
MAX_RATIO = 1032

# Formats that hold linear light, by OpenImageIO's names for them.
FORMATS = {"openexr": "an OpenEXR file", "hdr": "a Radiance HDR file"}


def write_channels(path: Path, planes: Mapping[str, Plane], attributes: Mapping[str, int | float | str] = {}) -> None:
    """Write (H, W) float32 planes as the channels of one EXR file with such attributes, whole or not at all.

    Raises
    ------
    FileError
        The file cannot be written; whatever was at `path` before is still there.
    """
    pixels = np.ascontiguousarray(np.stack(list(planes.values()), axis=-1))
    height, width, count = pixels.shape
    spec = oiio.ImageSpec(width, height, count, "float")
    spec.channelnames = tuple(planes)
    # Without a date, which OpenImageIO would add: the same planes make the same file.
    for name, value in {**attributes, "compression": "zip", "DateTime": ""}.items():
        spec.attribute(name, value)
    with written_whole(path) as aside:
        image = oiio.ImageBuf(spec)
        if not (image.set_pixels(spec.roi, pixels) and image.write(_name(aside), fileformat="openexr")):
            raise FileError(f"{path}: cannot be written ({one_line(image.geterror())}); is there room on the disk?")
        if not _has_last_row(aside):
            raise FileError(f"{path}: cannot be written (its end is missing); is there room on the disk?")


def read_channels(path: Path) -> dict[str, Plane]:
    """Read every channel of an EXR file as a (H, W) float32 plane, by name.

    Raises
    ------
    FileError
        The file is missing, of another format or damaged, or claims more pixels than it can hold.
    """
    names, pixels = read_pixels(path, ("openexr",))
    return {name: np.ascontiguousarray(pixels[..., index]) for index, name in enumerate(names)}


def read_attribute(path: Path, name: str) -> object:
    """The attribute of an EXR file called `name`; None where there is none; errors as of `read_channels`."""
    with _opened(path, ("openexr",)) as source:
        return source.spec().get(name)


def read_pixels(path: Path, formats: Collection[str]) -> tuple[tuple[str, ...], npt.NDArray[np.float32]]:
    """Read the names of an image's channels and its pixels, (H, W, C) float32.

    Parameters
    ----------
    path : Path
    formats : collection of str
        Those accepted, out of `FORMATS`.

    Raises
    ------
    FileError
        As of `read_channels`.
    """
    with _opened(path, formats) as source:
        spec = source.spec()
        pixels = source.read_image(0, 0, 0, spec.nchannels, "float")
        if pixels is None:
            raise FileError(f"{path}: expected a whole image, got a damaged one ({one_line(source.geterror())})")
        for index in range(spec.nchannels):
            # As floats, integers have come as fractions of the largest one.
            if spec.channelformat(index).basetype == oiio.UINT32:
                pixels[..., index] = source.read_image(0, 0, index, index + 1, oiio.UINT32)[..., 0]
        return tuple(spec.channelnames), pixels


@contextmanager
def _opened(path: Path, formats: Collection[str]) -> Iterator[Any]:
    """Open the image at `path`, whose header claims no more than it can hold; all that is wrong is a FileError."""
    require(path)
    if not path.is_file():  # but a folder; or a pipe, which might keep us waiting for ever
        raise FileError(f"{path}: expected {_described(formats)}, found something that is no file")
    try:
        source = oiio.ImageInput.open(_name(path))
        if source is None or source.format_name() not in formats:
            got = f"the format {source.format_name()}" if source else one_line(oiio.geterror())
            raise FileError(f"{path}: expected {_described(formats)}, got {got}")
        claimed, held = source.spec().image_bytes(), path.stat().st_size
        if claimed > max(TRUSTED, MAX_RATIO * held):
            raise FileError(f"{path}: expected a whole image, got {claimed} bytes of pixels in a file of {held}")
        yield source
    except UnicodeError as error:
        raise FileError(f"{path}: expected text in UTF-8 in its header, got another ({error})") from error
    except MemoryError as error:
        raise FileError(f"{path}: expected an image that fits into memory, got a larger one") from error


def _has_last_row(path: Path) -> bool:
    """Whether the end of a file has been written: of a disk that is full by then OpenImageIO says nothing."""
    source = oiio.ImageInput.open(_name(path))
    last = source.spec().height - 1 if source else 0
    return source is not None and source.read_scanlines(0, 0, last, last + 1, 0, 0, 1, "float") is not None


def _described(formats: Collection[str]) -> str:
    """What a file of one of these formats is called in errors."""
    return " or ".join(FORMATS[name] for name in formats)


def _name(path: Path) -> str:
    """`path` as OpenImageIO takes it."""
    try:
        return path.as_posix().encode().decode()
    except UnicodeEncodeError as error:
        raise FileError(f"{str(path)!a}: expected a name in UTF-8; rename it or its folder") from error
