"""The header of an OpenEXR file as bytes: OpenImageIO writes pixels, what else a file says passes through as it is.

OpenImageIO takes some attributes for orders to its writer, gives others a name or type of its own, adds the date and
leaves out types it does not know; and where the channels of a part differ in type, it takes them all through float32,
which cannot hold every 32-bit integer. So integers are written as floats of the same bits, and the header says what
they are.

Source: https://openexr.com/en/latest/OpenEXRFileLayout.html
"""

from __future__ import annotations

import mmap
import shutil
import struct
from collections.abc import Collection, Mapping, Sequence
from pathlib import Path

# An attribute's type and its value as in the file.
Attribute = tuple[str, bytes]
Attributes = dict[str, Attribute]

# What says how the pixels lie in the file. The writer decides that.
LAYOUT = ("channels", "chunkCount", "compression", "dataWindow", "lineOrder", "tiles", "type", "version")
# A small picture of what the pixels no longer are.
STALE = "preview"

START = 8  # bytes before the first attribute: the magic number, the version
MULTIPART, LONG_NAMES = 0x1000, 0x400  # bits of the version
SHORT = 31  # bytes of a name that are not long
UINT = 0


def read_attributes(path: Path) -> list[Attributes]:
    """Read the attributes of each part of a file; all but `LAYOUT` and `STALE`.

    Raises
    ------
    OSError
        The file cannot be read.
    ValueError
        It has no header.
    """
    with path.open("rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as content:
        parts, _ = _parsed(content)
    return [{name: part[name] for name in part if name not in (*LAYOUT, STALE)} for part in parts]


def encoded(value: int | float | str) -> Attribute:
    """Make an attribute of a number or a text; of a whole number that takes more than 32 bits, a text."""
    if isinstance(value, float):
        return "float", struct.pack("<f", value)
    if isinstance(value, int) and -(2**31) <= value < 2**31:
        return "int", struct.pack("<i", value)
    return "string", str(value).encode()


def copy_with_header(
    source: Path, target: Path, attributes: Sequence[Mapping[str, Attribute]], integers: Sequence[Collection[str]]
) -> None:
    """Copy a whole file of scanlines that OpenImageIO wrote, with a header that says something else.

    Parameters
    ----------
    source, target : Path
    attributes : sequence of mapping
        Those of each part, in place of all but `LAYOUT`.
    integers : sequence of collection of str
        The channels of each part whose floats have the bits of unsigned integers.
    """
    with source.open("rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as content:
        parts, old_end = _parsed(content)
        header = _header(content, _merged(parts, attributes, integers))
        # Behind a header is written where each chunk of pixels begins. The first one begins behind these numbers.
        (first,) = struct.unpack_from("<Q", content, old_end)
        places = struct.unpack_from(f"<{(first - old_end) // 8}Q", content, old_end)
        moved = len(header) - old_end
        with target.open("wb") as output:
            output.write(header + struct.pack(f"<{len(places)}Q", *(place + moved for place in places)))
            file.seek(first)
            shutil.copyfileobj(file, output)


def _merged(
    parts: Sequence[Attributes], attributes: Sequence[Mapping[str, Attribute]], integers: Sequence[Collection[str]]
) -> list[Attributes]:
    """What the parts of a new header say: how OpenImageIO wrote the pixels, and all else as wanted."""
    merged = []
    for part, own, names in zip(parts, attributes, integers, strict=True):
        layout = {name: part[name] for name in part if name in LAYOUT}
        kind, listed = layout["channels"]
        merged.append({**layout, "channels": (kind, _with_integers(listed, names)), **own})
    return merged


def _header(content: mmap.mmap, parts: Sequence[Attributes]) -> bytes:
    """The header that says the same as that of `content` of the file as a whole, and of its parts this."""
    magic, version = struct.unpack_from("<II", content)
    if any(len(text.encode()) > SHORT for part in parts for name, (kind, _) in part.items() for text in (name, kind)):
        version |= LONG_NAMES
    return struct.pack("<II", magic, version) + b"".join(map(_packed, parts)) + b"\0" * bool(version & MULTIPART)


def _parsed(content: mmap.mmap) -> tuple[list[Attributes], int]:
    """The attributes of each part, and where the header ends."""
    if len(content) < START:
        raise ValueError("expected a whole header, got one that is too short")
    multipart = struct.unpack_from("<I", content, 4)[0] & MULTIPART
    part, position = _parsed_part(content, START)
    parts = [part]
    while multipart and content[position : position + 1] != b"\0":
        part, position = _parsed_part(content, position)
        parts.append(part)
    return parts, position + bool(multipart)


def _parsed_part(content: mmap.mmap, position: int) -> tuple[Attributes, int]:
    """The attributes from `position` on, and where they end."""
    part: Attributes = {}
    while content[position : position + 1] != b"\0":
        name, position = _text(content, position)
        kind, position = _text(content, position)
        if not kind:
            raise ValueError("expected a whole header, got an attribute of no type")
        if len(content) < position + 4:
            raise ValueError("expected a whole header, got one that is cut off")
        (size,) = struct.unpack_from("<i", content, position)
        position += 4
        if not 0 <= size <= len(content) - position:
            raise ValueError(f"expected a whole header, got an attribute of {size} bytes")
        part[name] = kind, content[position : position + size]
        position += size
    return part, position + 1


def _text(content: mmap.mmap | bytes, position: int) -> tuple[str, int]:
    """The text that begins at `position`, and where it ends."""
    end = content.find(b"\0", position)
    if end < 0:
        raise ValueError("expected a whole header, got one that is cut off")
    return content[position:end].decode(), end + 1


def _packed(part: Attributes) -> bytes:
    """The attributes of a part as in a file."""
    return (
        b"".join(
            b"%s\0%s\0%s%s" % (name.encode(), kind.encode(), struct.pack("<i", len(value)), value)
            for name, (kind, value) in sorted(part.items())
        )
        + b"\0"
    )


def _with_integers(listed: bytes, integers: Collection[str]) -> bytes:
    """The list of a part's channels, those in `integers` declared unsigned integers."""
    changed, position = bytearray(listed), 0
    while listed[position]:
        name, position = _text(listed, position)
        if name in integers:
            struct.pack_into("<i", changed, position, UINT)
        position += 16  # the type, a flag, how densely the channel is sampled
    return bytes(changed)
