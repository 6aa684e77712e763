"""An image file in memory: parts with channels of their own pixel types, where they lie, and what else it says."""

from __future__ import annotations

import struct
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
import numpy.typing as npt

from svgf_cl.io.exr_header import Attributes
from svgf_cl.io.window import Window

Plane = npt.NDArray[np.float32] | npt.NDArray[np.uint32]


@dataclass(frozen=True)
class Windows:
    """Where the pixels of a file lie: all it has, those that are the picture, and the width of one over its height."""

    data: Window
    display: Window
    pixel_aspect: float = 1.0


@dataclass(frozen=True, eq=False)
class Part:
    """One part of a file.

    Parameters
    ----------
    planes : dict of str to (H, W) float32 or uint32
        The channels. No two parts of an image have one of the same name.
    attributes : dict of str to Attribute
        All that the header says and that is not how pixels are stored.
    halves : frozenset of str
        The channels that are 16-bit floats in the file.
    stored : mapping of str to str
        Channels whose name in the file is another, as other parts have that one too.
    """

    planes: Mapping[str, Plane]
    attributes: Attributes
    halves: frozenset[str] = frozenset()
    stored: Mapping[str, str] = field(default_factory=dict)

    def same_as(self, other: Part) -> bool:
        """Whether the other part holds the same, bit by bit."""
        return (
            (self.attributes, self.halves) == (other.attributes, other.halves)
            and self.planes.keys() == other.planes.keys()
            and all(
                plane.dtype == other.planes[name].dtype and plane.tobytes() == other.planes[name].tobytes()
                for name, plane in self.planes.items()
            )
        )


@dataclass(frozen=True, eq=False)
class Image:
    """All of a file."""

    windows: Windows
    parts: tuple[Part, ...]

    @property
    def planes(self) -> dict[str, Plane]:
        """Every channel, of whatever part."""
        return {name: plane for part in self.parts for name, plane in part.planes.items()}

    @property
    def chromaticities(self) -> tuple[float, ...] | None:
        """The x and y of red, green, blue and white, where the file says them."""
        kind, value = self.parts[0].attributes.get("chromaticities", ("", b""))
        return struct.unpack("<8f", value) if kind == "chromaticities" and len(value) == 32 else None

    def with_planes(self, planes: Mapping[str, npt.NDArray[np.float32]]) -> Image:
        """The same with these 32-bit floats in place of the channels of their names; new ones go to the first part."""
        parts = []
        new = planes.keys() - self.planes.keys()
        for index, part in enumerate(self.parts):
            own = {name: plane for name, plane in planes.items() if name in part.planes or (not index and name in new)}
            parts.append(replace(part, planes={**part.planes, **own}, halves=part.halves - own.keys()))
        return replace(self, parts=tuple(parts))

    def with_planes_alone(self, planes: Mapping[str, npt.NDArray[np.float32]]) -> Image:
        """The same with no other channels than these, in one part: the one that had the first of them."""
        first = next(iter(planes))
        part = next((part for part in self.parts if first in part.planes), self.parts[0])
        return replace(self, parts=(Part(dict(planes), part.attributes),))

    def without(self, attribute: str) -> Image:
        """The same without an attribute."""
        parts = (
            replace(part, attributes={name: part.attributes[name] for name in part.attributes if name != attribute})
            for part in self.parts
        )
        return replace(self, parts=tuple(parts))

    def same_as(self, other: Image) -> bool:
        """Whether the other image holds the same, bit by bit."""
        return (
            self.windows == other.windows
            and len(self.parts) == len(other.parts)
            and all(a.same_as(b) for a, b in zip(self.parts, other.parts, strict=True))
        )


def new_image(planes: Mapping[str, Plane], attributes: Attributes) -> Image:
    """An image of one part with these channels, (H, W) each, that fill its display window."""
    height, width = next(iter(planes.values())).shape
    window = Window(0, 0, width, height)
    box = "box2i", struct.pack("<4i", 0, 0, width - 1, height - 1)
    usual: Attributes = {
        "displayWindow": box,
        "pixelAspectRatio": ("float", struct.pack("<f", 1.0)),
        "screenWindowCenter": ("v2f", struct.pack("<2f", 0.0, 0.0)),
        "screenWindowWidth": ("float", struct.pack("<f", 1.0)),
    }
    return Image(Windows(window, window), (Part(dict(planes), {**usual, **attributes}),))
