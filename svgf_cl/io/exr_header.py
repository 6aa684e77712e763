"""Reads and writes the header of an OpenEXR file as bytes, so that attributes are copied unchanged.

The OpenEXR library only writes the pixels: it knows only some types of attributes, acts on some of them, and needs
every text in UTF-8, while a file may have other types and texts.

Source: https://openexr.com/en/latest/OpenEXRFileLayout.html
"""

from __future__ import annotations

import mmap
import shutil
import struct
from collections.abc import Mapping, Sequence
from pathlib import Path

# An attribute's type, and its value as bytes.
Attribute = tuple[str, bytes]
Attributes = dict[str, Attribute]

# The attributes that describe how the pixels are stored. The writer sets these.
LAYOUT = ("channels", "chunkCount", "compression", "dataWindow", "lineOrder", "tiles", "type", "version")
# A small picture of the old pixels.
STALE = "preview"

MAGIC = b"v/1\1"  # the first bytes of a file
START = 8  # bytes before the first attribute: the magic number and the version
MULTIPART, LONG_NAMES = 0x1000, 0x400  # bits of the version
SHORT = 31  # bytes of a name, at most, without LONG_NAMES


def read_header(path: Path) -> list[Attributes]:
    """Read the attributes of each part of a file.

    Raises
    ------
    OSError
        If the file cannot be read.
    ValueError
        If it is no OpenEXR file, or its header is damaged.
    """
    with path.open("rb") as file:
        begins = file.read(len(MAGIC))
        if begins != MAGIC:
            found = f"one that begins with {begins!r}" if begins else "an empty file"
            raise ValueError(f"expected an OpenEXR file, got {found}")
        with mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as content:
            parts, _ = _parsed(content)
    return parts


def passing(part: Attributes) -> Attributes:
    """Return the attributes of a part that are kept: all except `LAYOUT` and `STALE`."""
    return {name: part[name] for name in part if name not in (*LAYOUT, STALE)}


def encoded(value: int | float | str) -> Attribute:
    """Return a number or a text as an attribute; a whole number with more than 32 bits becomes a text."""
    if isinstance(value, float):
        return "float", struct.pack("<f", value)
    if isinstance(value, int) and -(2**31) <= value < 2**31:
        return "int", struct.pack("<i", value)
    return "string", str(value).encode()


def decoded(attribute: Attribute) -> int | float | str | bytes:
    """Return the number or the text of an attribute; for any other type, its bytes."""
    kind, value = attribute
    if kind in ("int", "float") and len(value) == 4:
        number: int | float = struct.unpack("<i" if kind == "int" else "<f", value)[0]
        return number
    return value.decode(errors="replace") if kind == "string" else value


def copy_with_header(source: Path, target: Path, attributes: Sequence[Mapping[str, Attribute]]) -> None:
    """Copy a scanline file, written from top to bottom, with other attributes.

    Parameters
    ----------
    source, target : Path
    attributes : sequence of mapping
        The attributes of each part, which replace all except `LAYOUT`.

    Raises
    ------
    ValueError
        If the end of the source is missing.
    """
    with source.open("rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as content:
        parts, old_end = _parsed(content)
        header = _header(content, _merged(parts, attributes))
        # After the header comes a table of where each chunk of pixels begins. The first chunk begins after the table.
        first = _number(content, old_end, "<Q")
        places = [_number(content, place, "<Q") for place in range(old_end, first, 8)]
        # A chunk begins with the number of its part, in a file of several parts, its line, and its number of bytes.
        last = max(places, default=0) + (8 if _number(content, 4, "<I") & MULTIPART else 4)
        if last + 4 + _number(content, last, "<i") != len(content):
            raise ValueError("its end is missing")
        moved = len(header) - old_end
        with target.open("wb") as output:
            output.write(header + struct.pack(f"<{len(places)}Q", *(place + moved for place in places)))
            file.seek(first)
            shutil.copyfileobj(file, output)


def copy_in_ascii(source: Path, target: Path) -> None:
    """Copy a file, with ``?`` for each byte that is not ASCII in the texts of its header."""
    content = source.read_bytes()
    parts, end = _parsed(content)
    header = content[:end]
    for name, (kind, value) in ((name, part[name]) for part in parts for name in part if part[name][0] == "string"):
        plain = value.decode("ascii", "replace").encode("ascii", "replace")  # the length stays the same
        header = header.replace(_packed({name: (kind, value)})[:-1], _packed({name: (kind, plain)})[:-1])
    target.write_bytes(header + content[end:])


def _number(content: mmap.mmap, place: int, form: str) -> int:
    """Read a number from a file; raise `ValueError` if the file ends before it."""
    try:
        number: int = struct.unpack_from(form, content, place)[0]
    except struct.error as error:
        raise ValueError("its end is missing") from error
    return number


def _merged(parts: Sequence[Attributes], attributes: Sequence[Mapping[str, Attribute]]) -> list[Attributes]:
    """Return the attributes of a new header: `LAYOUT` from the parts as written, and all others from `attributes`."""
    layouts = ({name: part[name] for name in part if name in LAYOUT} for part in parts)
    return [{**layout, **own} for layout, own in zip(layouts, attributes, strict=True)]


def _header(content: mmap.mmap, parts: Sequence[Attributes]) -> bytes:
    """Return a header with the version of `content` and with these parts."""
    magic, version = struct.unpack_from("<II", content)
    if any(len(text.encode()) > SHORT for part in parts for name, (kind, _) in part.items() for text in (name, kind)):
        version |= LONG_NAMES
    return struct.pack("<II", magic, version) + b"".join(map(_packed, parts)) + b"\0" * bool(version & MULTIPART)


def _parsed(content: mmap.mmap | bytes) -> tuple[list[Attributes], int]:
    """Return the attributes of each part, and where the header ends."""
    if len(content) < START:
        raise ValueError("expected a complete header, got one that is too short")
    multipart = struct.unpack_from("<I", content, 4)[0] & MULTIPART
    part, position = _parsed_part(content, START)
    parts = [part]
    while multipart and content[position : position + 1] != b"\0":
        part, position = _parsed_part(content, position)
        parts.append(part)
    return parts, position + bool(multipart)


def _parsed_part(content: mmap.mmap | bytes, position: int) -> tuple[Attributes, int]:
    """Return the attributes from `position` on, and where they end."""
    part: Attributes = {}
    while content[position : position + 1] != b"\0":
        name, position = text_at(content, position)
        kind, position = text_at(content, position)
        if not kind:
            raise ValueError("expected a complete header, got an attribute of no type")
        if len(content) < position + 4:
            raise ValueError("expected a complete header, got one that is cut off")
        (size,) = struct.unpack_from("<i", content, position)
        position += 4
        if not 0 <= size <= len(content) - position:
            raise ValueError(f"expected a complete header, got an attribute of {size} bytes")
        part[name] = kind, content[position : position + size]
        position += size
    return part, position + 1


def text_at(content: mmap.mmap | bytes, position: int) -> tuple[str, int]:
    """Return the text that begins at `position`, and where it ends."""
    end = content.find(b"\0", position)
    if end < 0:
        raise ValueError("expected a complete header, got one that is cut off")
    return content[position:end].decode(), end + 1


def _packed(part: Attributes) -> bytes:
    """Return the attributes of a part as bytes."""
    return (
        b"".join(
            b"%s\0%s\0%s%s" % (name.encode(), kind.encode(), struct.pack("<i", len(value)), value)
            for name, (kind, value) in sorted(part.items())
        )
        + b"\0"
    )
