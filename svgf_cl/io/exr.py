"""Writes OpenEXR files completely or not at all, and reads them with checks of all that their headers claim."""

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

# A file that claims more bytes of pixels than this is rejected, unless the file is large enough to contain them: no
# compression in use is much better than zlib's best, which turns 1032 bytes into one.
TRUSTED = 2**30
MAX_RATIO = 1032

# Most pixels of a display window that is larger than the data window, 16384 x 16384: a file can claim any number.
MAX_DISPLAY = 2**28


def write_channels(path: Path, planes: Mapping[str, Plane], attributes: Mapping[str, int | float | str] = {}) -> None:
    """Write (H, W) planes as the channels of one EXR file with these attributes, completely or not at all.

    Raises
    ------
    FileError
        If the file cannot be written; an earlier file at `path` stays as it was.
    """
    write_image(path, new_image(planes, {name: encoded(value) for name, value in attributes.items()}))


def write_image(path: Path, image: Image) -> None:
    """Write an EXR file with the image's parts, channels, windows and attributes; errors are those of `write_channels`.

    The same image always makes the same file: no date is added.
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
    """Return a part as the library needs it to write its pixels."""
    window = part.elsewhere or data
    first, last = (window.x, window.y), (window.x + window.width - 1, window.y + window.height - 1)
    header = {
        "compression": OpenEXR.Compression(COMPRESSIONS.index(part.lossless_compression)),
        "type": OpenEXR.scanlineimage,
        "dataWindow": (np.array(first, np.int32), np.array(last, np.int32)),
        # Not the right one yet; here it only has to be the same in all parts.
        "displayWindow": (np.zeros(2, np.int32), np.zeros(2, np.int32)),
    }
    planes = {part.stored.get(name, name): np.ascontiguousarray(plane) for name, plane in part.planes.items()}
    return OpenEXR.Part(header, planes, str(index))  # the library rejects two parts of one name


def _has_header(path: Path) -> bool:
    """Whether the library can read the header of a file."""
    try:
        OpenEXR.File(_name(path), header_only=True)
    except UnicodeDecodeError:  # only a text cannot be decoded
        return True
    except Exception:  # the library raises errors of any type
        return False
    return True


def is_exr(path: Path) -> bool:
    """Whether `path` is a file that begins as an OpenEXR file does.

    Raises
    ------
    FileError
        If it does not exist, or cannot be read.
    """
    require(path)
    if not path.is_file():  # reading a pipe might wait forever
        return False
    try:
        with path.open("rb") as file:
            return file.read(len(MAGIC)) == MAGIC
    except OSError as error:
        raise unreadable(path, error) from error


def read_attribute(path: Path, name: str) -> int | float | str | bytes | None:
    """Read the attribute `name` of the first part of an EXR file; None if there is none.

    The result is a number, a text, or bytes for any other type. Errors are those of `read_image`.
    """
    parts, _ = _checked(path)
    return decoded(parts[0][name]) if name in parts[0] else None


def read_attributes(path: Path) -> Attributes:
    """Read the attributes of the first part of an EXR file, type and bytes by name; errors as in `read_image`."""
    parts, _ = _checked(path)
    return parts[0]


def read_windows(path: Path) -> Windows:
    """Read the windows of an EXR file; errors as in `read_image`."""
    _, layouts = _checked(path)
    return layouts[0].windows


def read_image(path: Path) -> Image:
    """Read all parts of a file.

    A channel has its name in the file; if several parts have the same name, `unique_names` makes them different. Of
    tiles in several resolutions, the finest are read. Parts that have another view than the first, or other windows
    than the first part, are `Part.elsewhere`.

    Raises
    ------
    FileError
        If the file is missing, damaged or of another format, claims more pixels than it can contain, or has pixels of a
        kind that is not supported: deep pixels, or channels with fewer pixels than others.
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
    """Return a part whose channels have the names `called`; without these the part is elsewhere."""
    if called is None:
        return Part(planes, passing(header), layout.compression, elsewhere=layout.windows.data)
    stored = {own: name for name, own in called.items() if own != name}
    return Part({called[name]: planes[name] for name in planes}, passing(header), layout.compression, stored)


def _planes(path: Path, layouts: Sequence[Layout]) -> list[dict[str, Plane]]:
    """Read the channels of each part, by their names in the file."""
    try:
        parts = _decoded(path)
    except MemoryError as error:
        raise FileError(f"{path}: expected an image that fits into memory, got a larger one") from error
    except Exception as error:  # the library raises errors of any type
        raise FileError(f"{path}: expected a complete image, got a damaged one ({one_line(error)})") from error
    found = [{name: part.channels[name].pixels for name in in_usual_order(part.channels)} for part in parts]
    claimed = [
        {
            name: ((layout.windows.data.height, layout.windows.data.width), channel.dtype)
            for name, channel in layout.channels.items()
        }
        for layout in layouts
    ]
    # The library skips a part whose pixels it cannot read.
    if [{name: (plane.shape, plane.dtype) for name, plane in planes.items()} for planes in found] != claimed:
        raise FileError(f"{path}: expected a complete image, got a damaged one (some of its pixels cannot be read)")
    return found


def _decoded(path: Path) -> list[Any]:
    """Read the parts of a file with the library."""
    try:
        return [*OpenEXR.File(_name(path), separate_channels=True).parts]
    except UnicodeDecodeError:  # in a text of the header; a copy with ASCII texts has the same pixels
        with tempfile.TemporaryDirectory() as folder:
            copy = Path(folder, "copy.exr")
            copy_in_ascii(path, copy)
            return [*OpenEXR.File(_name(copy), separate_channels=True).parts]


def _checked(path: Path) -> tuple[list[Attributes], list[Layout]]:
    """Read and check the header of each part of a file; raise `FileError` for anything that is wrong."""
    require(path)
    if not path.is_file():  # a folder; or a pipe, and reading it might wait forever
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
    """Raise `ValueError` if a file of `held` bytes claims more pixels than it, or memory, can contain."""
    claimed = sum(layout.size for layout in layouts)
    if claimed > max(TRUSTED, MAX_RATIO * held):
        raise ValueError(f"expected a complete image, got {claimed} bytes of pixels in a file of {held}")
    windows = layouts[0].windows
    if windows.display.area > max(MAX_DISPLAY, windows.data.area):
        raise ValueError(f"expected a display window of at most {MAX_DISPLAY} pixels, got {windows.display}")


def _check_kind(layouts: Sequence[Layout]) -> None:
    """Raise `ValueError` if a file has pixels of a kind that is not supported."""
    if any(layout.is_deep for layout in layouts):
        raise ValueError("expected flat pixels, got deep ones; flatten the image first")
    sparse = [name for layout in layouts for name, channel in layout.channels.items() if not channel.is_full]
    if sparse:
        raise ValueError(f"expected a value for every pixel in each channel, got fewer in {', '.join(sparse)}")


def _name(path: Path) -> str:
    """Return `path` in the form that the library accepts."""
    try:
        return path.as_posix().encode().decode()
    except UnicodeEncodeError as error:
        raise FileError(f"{str(path)!a}: expected a name in UTF-8; rename it or its folder") from error
