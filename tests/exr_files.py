"""EXR files byte by byte, with headers that no library would write for a test."""

from __future__ import annotations

import struct
from collections.abc import Mapping, Sequence

import numpy as np

from svgf_cl.io.exr_header import Attribute
from svgf_cl.io.window import Window

TYPES = {np.dtype(np.uint32): 0, np.dtype(np.float16): 1, np.dtype(np.float32): 2}


def exr_bytes(
    planes: Mapping[str, np.ndarray],
    attributes: Mapping[str, Attribute] = {},
    at: tuple[int, int] = (0, 0),
    display: Window | None = None,
    sampling: Mapping[str, int] = {},
    aspect: float = 1.0,
) -> bytes:
    """An uncompressed file of one part, its (H, W) uint32, float16 or float32 channels as they are."""
    every = {name: sampling.get(name, 1) for name in planes}
    own = {**usual_attributes(planes, at, display, every, aspect), **attributes}
    header = version(2, [*attributes, *planes]) + packed(own)
    rows = [row(planes, every, y) for y in range(height_of(planes))]
    return header + chunks(len(header), rows, at[1])


def multipart_bytes(
    parts: Mapping[str, Mapping[str, np.ndarray]],
    attributes: Mapping[str, Attribute] = {},
    at: tuple[int, int] = (0, 0),
) -> bytes:
    """An uncompressed file of several parts by their names, each with these attributes, of the same windows."""
    header = version(2 | 0x1000, [name for planes in parts.values() for name in planes])
    for part, planes in parts.items():
        kind: dict[str, Attribute] = {
            "name": ("string", part.encode()),
            "type": ("string", b"scanlineimage"),
            "chunkCount": ("int", struct.pack("<i", height_of(planes))),
        }
        header += packed({**usual_attributes(planes, at, None, dict.fromkeys(planes, 1), 1.0), **attributes, **kind})
    header += b"\0"
    content = [
        struct.pack("<iii", number, at[1] + y, len(pixels)) + pixels
        for number, planes in enumerate(parts.values())
        for y in range(height_of(planes))
        for pixels in [row(planes, dict.fromkeys(planes, 1), y)]
    ]
    return header + placed(len(header), content)


def height_of(planes: Mapping[str, np.ndarray]) -> int:
    return len(next(iter(planes.values())))


def version(bits: int, names: Sequence[str]) -> bytes:
    """What a file begins with."""
    long = any(len(name.encode()) > 31 for name in names)
    return struct.pack("<II", 20000630, bits | (0x400 if long else 0))


def usual_attributes(
    planes: Mapping[str, np.ndarray],
    at: tuple[int, int],
    display: Window | None,
    every: Mapping[str, int],
    aspect: float,
) -> dict[str, Attribute]:
    """The attributes that every part has."""
    height, width = next(iter(planes.values())).shape
    window = Window(*at, width, height)
    listed = [
        name.encode() + b"\0" + struct.pack("<iB3xii", TYPES[planes[name].dtype], 0, every[name], every[name])
        for name in in_file(planes)
    ]
    return {
        "channels": ("chlist", b"".join(listed) + b"\0"),
        "compression": ("compression", b"\0"),
        "dataWindow": box(window),
        "displayWindow": box(display or window),
        "lineOrder": ("lineOrder", b"\0"),
        "pixelAspectRatio": ("float", struct.pack("<f", aspect)),
        "screenWindowCenter": ("v2f", struct.pack("<2f", 0.5, 0.25)),
        "screenWindowWidth": ("float", struct.pack("<f", 2.0)),
    }


def packed(attributes: Mapping[str, Attribute]) -> bytes:
    """The header of a part."""
    written = [
        b"%s\0%s\0%s%s" % (name.encode(), kind.encode(), struct.pack("<i", len(value)), value)
        for name, (kind, value) in attributes.items()
    ]
    return b"".join(written) + b"\0"


def in_file(planes: Mapping[str, np.ndarray]) -> list[str]:
    """The channels in the order that a file has them in."""
    return sorted(planes, key=str.encode)


def row(planes: Mapping[str, np.ndarray], every: Mapping[str, int], y: int) -> bytes:
    """The pixels of a row."""
    return b"".join(planes[name][y, :: every[name]].tobytes() for name in in_file(planes) if y % every[name] == 0)


def chunks(start: int, rows: Sequence[bytes], first: int) -> bytes:
    """Where each row of the only part is, and the rows."""
    return placed(start, [struct.pack("<ii", first + y, len(pixels)) + pixels for y, pixels in enumerate(rows)])


def placed(start: int, content: Sequence[bytes]) -> bytes:
    """Where each chunk is, and the chunks."""
    places = start + 8 * len(content) + np.cumsum([0, *map(len, content)])[:-1]
    return places.astype("<u8").tobytes() + b"".join(content)


def box(window: Window) -> Attribute:
    """A window as a header has it."""
    x, y, width, height = window
    return "box2i", struct.pack("<4i", x, y, x + width - 1, y + height - 1)
