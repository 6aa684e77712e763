"""Reads the layout of pixels from an OpenEXR header: windows, channels with their types, compression, and view.

Source: https://openexr.com/en/latest/OpenEXRFileLayout.html
"""

from __future__ import annotations

import struct
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from svgf_cl.io.exr_header import Attributes, text_at
from svgf_cl.io.image import COMPRESSIONS, Windows
from svgf_cl.io.window import Window

# Pixel types, by their numbers in the list of channels.
TYPES = (np.dtype(np.uint32), np.dtype(np.float16), np.dtype(np.float32))


@dataclass(frozen=True)
class Channel:
    """The pixel type of a channel, and whether it has a value for every pixel."""

    dtype: np.dtype[Any]
    is_full: bool


@dataclass(frozen=True)
class Layout:
    """The layout of a part's pixels.

    Parameters
    ----------
    windows : Windows
    channels : dict of str to Channel
    compression : str
        One of `COMPRESSIONS`.
    name, view : str
        The part's name and view; empty if it has none.
    is_deep : bool
        Whether pixels have varying numbers of samples.
    """

    windows: Windows
    channels: dict[str, Channel]
    compression: str
    name: str
    view: str
    is_deep: bool

    @property
    def size(self) -> int:
        """Bytes of the pixels without compression."""
        return self.windows.data.area * sum(channel.dtype.itemsize for channel in self.channels.values())


def layout_of(part: Attributes) -> Layout:
    """Return the layout of a part from its attributes; raise `ValueError` if one is missing or invalid."""
    (aspect,) = _numbers(part, "pixelAspectRatio", "float", "<f")
    (compression,) = _numbers(part, "compression", "compression", "<B")
    if compression >= len(COMPRESSIONS):
        raise ValueError(f"expected a compression of {', '.join(COMPRESSIONS)}, got number {compression}")
    windows = Windows(_window(part, "dataWindow"), _window(part, "displayWindow"), aspect)
    if min(windows.data[2:]) < 1:
        raise ValueError(f"expected at least one pixel, got a data window of {windows.data}")
    return Layout(
        windows,
        dict(_channels(part)),
        COMPRESSIONS[compression],
        _text(part, "name"),
        _text(part, "view"),
        _text(part, "type") in ("deepscanline", "deeptile"),
    )


def _numbers(part: Attributes, name: str, kind: str, form: str) -> tuple[Any, ...]:
    """Return the numbers of an attribute; raise `ValueError` if it is missing or of another type."""
    found, value = part.get(name, ("none", b""))
    if found != kind or len(value) != struct.calcsize(form):
        raise ValueError(
            f"expected a complete header with {name} of type {kind}, got {len(value)} bytes of type {found}"
        )
    return struct.unpack(form, value)


def _window(part: Attributes, name: str) -> Window:
    left, top, right, bottom = _numbers(part, name, "box2i", "<4i")
    return Window(left, top, right - left + 1, bottom - top + 1)


def _text(part: Attributes, name: str) -> str:
    """Return the text of an attribute; empty if it is missing."""
    kind, value = part.get(name, ("", b""))
    return value.decode() if kind == "string" else ""


def _channels(part: Attributes) -> Iterator[tuple[str, Channel]]:
    """Yield the name and the type of each channel of a part."""
    kind, listed = part.get("channels", ("none", b""))
    position = 0
    while kind == "chlist" and listed[position : position + 1] not in (b"", b"\0"):
        name, position = text_at(listed, position)
        if len(listed) < position + 16:
            break
        number, across, down = struct.unpack_from("<i4xii", listed, position)
        if not 0 <= number < len(TYPES):
            raise ValueError(f"expected pixels of a known type, got number {number} in channel {name}")
        yield name, Channel(TYPES[number], (across, down) == (1, 1))
        position += 16
    if kind != "chlist" or listed[position:] != b"\0" or position == 0:
        raise ValueError("expected a complete header with a list of channels, got none or a damaged one")
