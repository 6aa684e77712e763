"""The images of materials, and their placement on a surface."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from svgf_cl.errors import shown
from svgf_cl_tracer.folder import found_inside
from svgf_cl_tracer.images import Images
from svgf_cl_tracer.losses import Losses
from svgf_cl_tracer.textures import Image

from .library import Definition, Map
from .text import is_number, uncommented

# Images that are used texel by texel; of other images the mean is used. All images have the placement of the first one.
PLACED = ("map_kd", "map_ke", "map_d")

# The names of an image's channels in -imfchan, which may also ask for opacity (m) or brightness (l).
CHANNELS = {"r": 0, "g": 1, "b": 2}
HALF = 128

# Options that have no effect here, and options that have none with these words.
NEUTRAL = {"-s", "-o", "-bm", "-boost", "-blendu", "-blendv", "-cc", "-imfchan", "-texres", "-type"}
NEUTRAL_VALUES: dict[str, list[object]] = {"-clamp": ["off"], "-mm": [0.0, 1.0], "-t": [0.0, 0.0, 0.0]}


class Maps:
    """The images of one model; each is decoded once.

    Parameters
    ----------
    root : Path
        The model's folder; no file outside it is read.
    losses : Losses
        Collects what is shown differently from the files.
    """

    def __init__(self, root: Path, losses: Losses) -> None:
        self._root, self._losses = root, losses
        self._images = Images()
        self._masked: dict[tuple[int, int, str], Image] = {}

    def pixels(self, definition: Definition, keyword: str) -> Image | None:
        """The image of a material's statement; None if there is no statement or no such image.

        Raises
        ------
        SceneError
            If it cannot be decoded.
        """
        if keyword not in definition.maps:
            return None
        named = definition.maps[keyword]
        names = (named.name, uncommented(named.name))  # a # may be part of the name or begin a comment
        path = next(filter(None, (found_inside(self._root, name, definition.library.parent) for name in names)), None)
        if path is None:
            self._losses.add("images that are not in its folder or below, shown without", shown(named.name))
            return None
        self._note_options(definition, keyword)
        return self._images.pixels(str(path), path.read_bytes)

    def base(self, definition: Definition) -> tuple[Image | None, bool]:
        """The image of a material's colour (map_Kd), and whether its fourth channel is opacity (map_d)."""
        colour, mask = self.pixels(definition, "map_kd"), self.pixels(definition, "map_d")
        if mask is None:
            if colour is not None and colour.shape[2] == 4 and (colour[..., 3] < HALF).any():
                name = shown(definition.maps["map_kd"].name)
                self._losses.add("images with holes that no map_d names, shown without holes", name)
            return colour, False
        channel = next(iter(definition.maps["map_d"].options.get("-imfchan", ())), "")
        key = (id(colour), id(mask), channel)
        if key not in self._masked:
            self._masked[key] = _masked(colour, _opacity(mask, channel))
        return self._masked[key], True

    def placed(self, definition: Definition, uv: NDArray[np.floating]) -> NDArray[np.floating]:
        """Texture coordinates (..., 2), scaled (-s) and shifted (-o) as the material defines."""
        scale, offset = _placement(definition)
        return uv * scale + offset

    def _note_options(self, definition: Definition, keyword: str) -> None:
        named = definition.maps[keyword]
        unread = [option for option, words in named.options.items() if not _is_neutral(option, words)]
        if keyword in PLACED and named.placement() != _placement(definition):
            unread.append("-s or -o beside those of another image")
        for option in unread:
            self._losses.add("options of images that are not read", option)


def _is_neutral(option: str, words: list[str]) -> bool:
    values = [float(word) if is_number(word) else word for word in words]
    return option in NEUTRAL or values == NEUTRAL_VALUES[option][: len(values)]


def _placement(definition: Definition) -> tuple[tuple[float, float], tuple[float, float]]:
    placed = (definition.maps[keyword] for keyword in PLACED if keyword in definition.maps)
    return next(placed, Map("", {})).placement()


def _opacity(mask: Image, channel: str) -> NDArray[np.uint8]:
    """The opacity (h, w) of a mask: its opacity channel if it has one, otherwise its brightness."""
    if channel in CHANNELS:
        return mask[..., CHANNELS[channel]]
    if channel != "l" and mask.shape[2] == 4 and mask[..., 3].min() < 255:
        return mask[..., 3]
    brightness: NDArray[np.uint8] = mask[..., :3].mean(2, np.float32).round().astype(np.uint8)
    return brightness


def _masked(colour: Image | None, opacity: NDArray[np.uint8]) -> Image:
    """`colour` (white if there is none) with `opacity` as its fourth channel, at the resolution of `colour`."""
    if colour is None:
        colour = np.broadcast_to(np.uint8(255), (*opacity.shape, 3))
    height, width = colour.shape[:2]
    rows, columns = (
        np.arange(count) * have // count for count, have in zip((height, width), opacity.shape, strict=True)
    )
    return np.dstack([colour[..., :3], opacity[np.ix_(rows, columns)]])
