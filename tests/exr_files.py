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
    names = sorted(planes, key=str.encode)
    height, width = planes[names[0]].shape
    window = Window(*at, width, height)
    every = {name: sampling.get(name, 1) for name in names}
    listed = [
        name.encode() + b"\0" + struct.pack("<iB3xii", TYPES[planes[name].dtype], 0, every[name], every[name])
        for name in names
    ]
    own: dict[str, Attribute] = {
        "channels": ("chlist", b"".join(listed) + b"\0"),
        "compression": ("compression", b"\0"),
        "dataWindow": box(window),
        "displayWindow": box(display or window),
        "lineOrder": ("lineOrder", b"\0"),
        "pixelAspectRatio": ("float", struct.pack("<f", aspect)),
        "screenWindowCenter": ("v2f", struct.pack("<2f", 0.5, 0.25)),
        "screenWindowWidth": ("float", struct.pack("<f", 2.0)),
    }
    packed = [
        b"%s\0%s\0%s%s" % (name.encode(), kind.encode(), struct.pack("<i", len(value)), value)
        for name, (kind, value) in (own | dict(attributes)).items()
    ]
    long = any(len(name.encode()) > 31 for name in [*attributes, *names])
    header = struct.pack("<II", 20000630, 2 | (0x400 if long else 0)) + b"".join(packed) + b"\0"
    return header + chunks(len(header), [row(planes, names, every, y) for y in range(height)], at[1])


def row(planes: Mapping[str, np.ndarray], names: Sequence[str], every: Mapping[str, int], y: int) -> bytes:
    """The pixels of a row."""
    return b"".join(planes[name][y, :: every[name]].tobytes() for name in names if y % every[name] == 0)


def chunks(start: int, rows: Sequence[bytes], first: int) -> bytes:
    """Where each chunk is, and the chunks."""
    packed = [struct.pack("<ii", first + y, len(pixels)) + pixels for y, pixels in enumerate(rows)]
    places = start + 8 * len(rows) + np.cumsum([0, *map(len, packed)])[:-1]
    return places.astype("<u8").tobytes() + b"".join(packed)


def box(window: Window) -> Attribute:
    """A window as a header has it."""
    x, y, width, height = window
    return "box2i", struct.pack("<4i", x, y, x + width - 1, y + height - 1)
