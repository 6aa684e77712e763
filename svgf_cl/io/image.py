"""`Image`: an image file in memory, with its parts, channels, windows and attributes."""

from __future__ import annotations

import struct
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
import numpy.typing as npt

from svgf_cl.io.exr_header import Attributes
from svgf_cl.io.window import Window

Plane = npt.NDArray[np.float16] | npt.NDArray[np.float32] | npt.NDArray[np.uint32]

# Compressions, by their numbers in a file.
COMPRESSIONS = (
    *("none", "rle", "zips", "zip", "piz", "pxr24", "b44", "b44a", "dwaa", "dwab"),
    *("htj2k256", "htj2k32"),
)
LOSSLESS = frozenset({"none", "rle", "zips", "zip", "piz", "htj2k256", "htj2k32"})


@dataclass(frozen=True)
class Windows:
    """The windows of a file (its pixels, and the picture), and the width of a pixel over its height."""

    data: Window
    display: Window
    pixel_aspect: float = 1.0


@dataclass(frozen=True, eq=False)
class Part:
    """One part of a file.

    Parameters
    ----------
    planes : dict of str to (H, W) float16, float32 or uint32
        The channels, with the types that they have in the file. Parts that are not elsewhere have no name in common.
    attributes : dict of str to Attribute
        All attributes of the header, except those about how pixels are stored.
    compression : str
        One of `COMPRESSIONS`.
    stored : mapping of str to str
        For channels that were renamed because several parts have the same name: the name in the file.
    elsewhere : Window, optional
        The data window of a part that has another view or other windows than the image. Such a part is kept, but its
        channels are not the image's.
    """

    planes: Mapping[str, Plane]
    attributes: Attributes
    compression: str = "zip"
    stored: Mapping[str, str] = field(default_factory=dict)
    elsewhere: Window | None = None

    @property
    def lossless_compression(self) -> str:
        """The compression to write the part with: its own if that is lossless, else zip."""
        # PXR24 reduces 32-bit floats to 24 bits, and is lossless for other types.
        keeps = self.compression == "pxr24" and all(plane.dtype != np.float32 for plane in self.planes.values())
        return self.compression if keeps or self.compression in LOSSLESS else "zip"

    def same_as(self, other: Part) -> bool:
        """Whether the other part has the same content, bit by bit, and is written in the same way."""
        return (
            (self.attributes, self.elsewhere) == (other.attributes, other.elsewhere)
            and self.lossless_compression == other.lossless_compression
            and self.planes.keys() == other.planes.keys()
            and all(
                plane.dtype == other.planes[name].dtype and plane.tobytes() == other.planes[name].tobytes()
                for name, plane in self.planes.items()
            )
        )


@dataclass(frozen=True, eq=False)
class Image:
    """The content of a file; the windows are those of its first part."""

    windows: Windows
    parts: tuple[Part, ...]

    @property
    def planes(self) -> dict[str, Plane]:
        """All channels of the parts that are not elsewhere."""
        return {name: plane for part in self.parts if not part.elsewhere for name, plane in part.planes.items()}

    @property
    def chromaticities(self) -> tuple[float, ...] | None:
        """The x and y of red, green, blue and white, if the file has them."""
        kind, value = self.parts[0].attributes.get("chromaticities", ("", b""))
        return struct.unpack("<8f", value) if kind == "chromaticities" and len(value) == 32 else None

    def with_planes(self, planes: Mapping[str, Plane], beside: str | None = None) -> Image:
        """Return the image with these channels, which replace channels of the same names.

        New channels go to the part that has the channel `beside`, or to the first part.
        """
        new = planes.keys() - self.planes.keys()
        home = self._part_of(beside)
        parts = []
        for part in self.parts:
            replaced = set() if part.elsewhere else planes.keys() & part.planes.keys()
            own = {name: plane for name, plane in planes.items() if name in replaced or (part is home and name in new)}
            parts.append(replace(part, planes={**part.planes, **own}))
        return replace(self, parts=tuple(parts))

    def with_planes_alone(self, planes: Mapping[str, Plane]) -> Image:
        """Return the image with only these channels, in one part: the one that had the first of them."""
        home = self._part_of(next(iter(planes)))
        return replace(self, parts=(Part(dict(planes), home.attributes, home.compression),))

    def _part_of(self, channel: str | None) -> Part:
        """Return the part that has a channel, or the first part if none has it."""
        return next((part for part in self.parts if channel in part.planes and not part.elsewhere), self.parts[0])

    def without(self, attribute: str) -> Image:
        """Return the image without an attribute."""
        parts = (
            replace(part, attributes={name: part.attributes[name] for name in part.attributes if name != attribute})
            for part in self.parts
        )
        return replace(self, parts=tuple(parts))

    def same_as(self, other: Image) -> bool:
        """Whether the other image has the same content, bit by bit."""
        return (
            self.windows == other.windows
            and len(self.parts) == len(other.parts)
            and all(a.same_as(b) for a, b in zip(self.parts, other.parts, strict=True))
        )


def new_image(planes: Mapping[str, Plane], attributes: Attributes) -> Image:
    """Return an image of one part with these channels, (H, W) each, which fill its display window."""
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
