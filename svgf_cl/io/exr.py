"""OpenEXR files: written completely or not at all, and read without trusting their claims."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import OpenEXR

from svgf_cl.errors import FileError, one_line
from svgf_cl.io.atomic import require, unreadable, written_whole
from svgf_cl.io.exr_header import (
    MAGIC,
    Attributes,
    copy_in_ascii,
    copy_with_header,
    decoded,
    encoded,
    passing,
    read_header,
)
from svgf_cl.io.exr_layout import Layout, layout_of
from svgf_cl.io.image import COMPRESSIONS, Image, Part, Plane, Windows, new_image
from svgf_cl.io.layers import in_usual_order, unique_names
from svgf_cl.io.window import Window

# A file that claims more bytes of pixels than these is refused, unless it is so large that they can be in it: no method
# of compression in use makes much less of a picture than zlib's best, one byte of 1032.
TRUSTED = 2**30
MAX_RATIO = 1032

# Pixels of a display window beyond those of the data window, which cost nothing to claim: 16384 x 16384.
MAX_DISPLAY = 2**28


def write_channels(path: Path, planes: Mapping[str, Plane], attributes: Mapping[str, int | float | str] = {}) -> None:
    """Write (H, W) planes as the channels of one EXR file with such attributes, whole or not at all.

    Raises
    ------
    FileError
        The file cannot be written; whatever was at `path` before is still there.
    """
    write_image(path, new_image(planes, {name: encoded(value) for name, value in attributes.items()}))


def write_image(path: Path, image: Image) -> None:
    """Write an EXR file of these parts, channels, windows and attributes; errors of `write_channels`.

    The same image makes the same file: there is no date in it but one among the attributes.
    """
    with written_whole(path) as aside:
        pixels = aside.with_name(f".pixels{aside.name}")
        parts = [_pixels(image.windows.data, index, part) for index, part in enumerate(image.parts)]
        try:
            OpenEXR.File(parts).write(_name(pixels))
            copy_with_header(pixels, aside, [part.attributes for part in image.parts])
        except (RuntimeError, ValueError) as error:
            raise FileError(f"{path}: cannot be written ({one_line(error)}); the disk may be full") from error
        finally:
            pixels.unlink(missing_ok=True)
        if not _has_header(aside):
            raise FileError(f"{path}: cannot be written (one of the attributes to keep is damaged)")


def _pixels(data: Window, index: int, part: Part) -> Any:
    """What the library must know to write the pixels of a part."""
    window = part.elsewhere or data
    first, last = (window.x, window.y), (window.x + window.width - 1, window.y + window.height - 1)
    header = {
        "compression": OpenEXR.Compression(COMPRESSIONS.index(part.lossless_compression)),
        "type": OpenEXR.scanlineimage,
        "dataWindow": (np.array(first, np.int32), np.array(last, np.int32)),
        # Not yet the right one, but that of all parts, as it must be.
        "displayWindow": (np.zeros(2, np.int32), np.zeros(2, np.int32)),
    }
    planes = {part.stored.get(name, name): np.ascontiguousarray(plane) for name, plane in part.planes.items()}
    return OpenEXR.Part(header, planes, str(index))  # two of one name would not be written


def _has_header(path: Path) -> bool:
    """Whether the library can read the header of a file."""
    try:
        OpenEXR.File(_name(path), header_only=True)
    except UnicodeDecodeError:  # it could, but for a text
        return True
    except Exception:  # of whatever type the library's are
        return False
    return True


def is_exr(path: Path) -> bool:
    """Whether what is at `path` is a file that says it is an OpenEXR file.

    Raises
    ------
    FileError
        There is nothing, or it cannot be read.
    """
    require(path)
    if not path.is_file():  # but a pipe, which might keep us waiting for ever
        return False
    try:
        with path.open("rb") as file:
            return file.read(len(MAGIC)) == MAGIC
    except OSError as error:
        raise unreadable(path, error) from error


def read_channels(path: Path) -> dict[str, Plane]:
    """Read the channels of an EXR file as (H, W) planes, by the names of `read_image`; errors as of it."""
    return read_image(path).planes


def read_attribute(path: Path, name: str) -> int | float | str | bytes | None:
    """The attribute of the first part of an EXR file called `name`; None where there is none.

    A number or a text; what is neither, as the bytes that it is. Errors are those of `read_image`.
    """
    parts, _ = _checked(path)
    return decoded(parts[0][name]) if name in parts[0] else None


def read_attributes(path: Path) -> Attributes:
    """Read the header of the first part of an EXR file, type and bytes by name; errors as of `read_image`."""
    parts, _ = _checked(path)
    return parts[0]


def read_windows(path: Path) -> Windows:
    """Read where the pixels of an EXR file lie; errors as of `read_image`."""
    _, layouts = _checked(path)
    return layouts[0].windows


def read_image(path: Path) -> Image:
    """Read all of a file, every part of it.

    A channel goes by its name in the file; where several parts have that name, `unique_names` says by which. Of tiles
    in several resolutions the finest is read. Parts of another view than the first one, and those that do not have the
    windows of the first part, are `Part.elsewhere`.

    Raises
    ------
    FileError
        The file is missing, of another format or damaged, or claims more pixels than it can hold, or what it holds is
        of a kind that is not read: deep pixels, channels with fewer pixels than others.
    """
    headers, layouts = _checked(path)
    view = next((layout.view for layout in layouts if layout.view), "")
    here = [layout.view in ("", view) and layout.windows == layouts[0].windows for layout in layouts]
    try:
        called = iter(
            unique_names([(part.name, part.channels) for part, read in zip(layouts, here, strict=True) if read])
        )
    except ValueError as error:
        raise FileError(f"{path}: {error}") from error
    parts = [
        _part(header, layout, planes, next(called) if read else None)
        for header, layout, planes, read in zip(headers, layouts, _planes(path, layouts), here, strict=True)
    ]
    return Image(layouts[0].windows, tuple(parts))


def _part(header: Attributes, layout: Layout, planes: Mapping[str, Plane], called: Mapping[str, str] | None) -> Part:
    """A part whose channels go by other names than in the file; without such names it is elsewhere."""
    if called is None:
        return Part(planes, passing(header), layout.compression, elsewhere=layout.windows.data)
    stored = {own: name for name, own in called.items() if own != name}
    return Part({called[name]: planes[name] for name in planes}, passing(header), layout.compression, stored)


def _planes(path: Path, layouts: Sequence[Layout]) -> list[dict[str, Plane]]:
    """The channels of each part, by their names in the file."""
    try:
        parts = _decoded(path)
    except MemoryError as error:
        raise FileError(f"{path}: expected an image that fits into memory, got a larger one") from error
    except Exception as error:  # of whatever type the library's are
        raise FileError(f"{path}: expected a complete image, got a damaged one ({one_line(error)})") from error
    found = [{name: part.channels[name].pixels for name in in_usual_order(part.channels)} for part in parts]
    claimed = [
        {
            name: ((layout.windows.data.height, layout.windows.data.width), channel.dtype)
            for name, channel in layout.channels.items()
        }
        for layout in layouts
    ]
    # The library leaves out a part whose pixels it cannot read.
    if [{name: (plane.shape, plane.dtype) for name, plane in planes.items()} for planes in found] != claimed:
        raise FileError(f"{path}: expected a complete image, got a damaged one (some of its pixels cannot be read)")
    return found


def _decoded(path: Path) -> list[Any]:
    """The parts of a file as the library reads them."""
    try:
        return [*OpenEXR.File(_name(path), separate_channels=True).parts]
    except UnicodeDecodeError:  # in a text of its header, which passes through as it is
        with tempfile.TemporaryDirectory() as folder:
            copy = Path(folder, "copy.exr")
            copy_in_ascii(path, copy)
            return [*OpenEXR.File(_name(copy), separate_channels=True).parts]


def _checked(path: Path) -> tuple[list[Attributes], list[Layout]]:
    """Read the header of a file that can be read, part by part; all that is wrong with it is a FileError."""
    require(path)
    if not path.is_file():  # but a folder; or a pipe, which might keep us waiting for ever
        raise FileError(f"{path}: expected an OpenEXR file, found something that is not a file")
    try:
        _name(path)
        headers = read_header(path)
        layouts = [layout_of(header) for header in headers]
        _check_claims(layouts, path.stat().st_size)
        _check_kind(layouts)
    except FileError:
        raise
    except OSError as error:
        raise unreadable(path, error) from error
    except UnicodeError as error:
        raise FileError(f"{path}: expected text in UTF-8 in its header, got another encoding ({error})") from error
    except ValueError as error:
        raise FileError(f"{path}: {error}") from error
    return headers, layouts


def _check_claims(layouts: Sequence[Layout], held: int) -> None:
    """Raise `ValueError` if a file of `held` bytes claims more pixels than it, or the memory, can hold."""
    claimed = sum(layout.size for layout in layouts)
    if claimed > max(TRUSTED, MAX_RATIO * held):
        raise ValueError(f"expected a complete image, got {claimed} bytes of pixels in a file of {held}")
    windows = layouts[0].windows
    if windows.display.area > max(MAX_DISPLAY, windows.data.area):
        raise ValueError(f"expected a display window of at most {MAX_DISPLAY} pixels, got {windows.display}")


def _check_kind(layouts: Sequence[Layout]) -> None:
    """Raise `ValueError` where a file is of a kind that is not read."""
    if any(layout.is_deep for layout in layouts):
        raise ValueError("expected flat pixels, got deep ones; flatten the image first")
    sparse = [name for layout in layouts for name, channel in layout.channels.items() if not channel.is_full]
    if sparse:
        raise ValueError(f"expected a value for every pixel in each channel, got fewer in {', '.join(sparse)}")


def _name(path: Path) -> str:
    """`path` as the library takes it."""
    try:
        return path.as_posix().encode().decode()
    except UnicodeEncodeError as error:
        raise FileError(f"{str(path)!a}: expected a name in UTF-8; rename it or its folder") from error
