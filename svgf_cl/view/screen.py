"""`Screen`: converts pictures for the page, and measures them against the reference."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from svgf_cl.compare.metrics import psnr, temporal_error
from svgf_cl.io.display import Bytes, to_bytes
from svgf_cl.view.clip import Item, Picture
from svgf_cl.view.player import Filtered

NOISY, DENOISED, REFERENCE = "noisy", "denoised", "reference"

# index, exposure and pictures before the first frame; no frame follows this index
NOTHING: tuple[int, float, Mapping[str, Picture]] = (-2, 0.0, {})

# Floats are looked up by their upper bits: sign, exponent and 11 bits of the mantissa.
DROPPED = 12


@lru_cache(maxsize=8)
def table(exposure: float) -> Bytes:
    """The bytes of floats by their upper bits, computed for the middle of the floats that share them."""
    first = (np.arange(2 ** (32 - DROPPED), dtype=np.uint32) << DROPPED).view(np.float32)
    middle = (first.view(np.uint32) + (1 << (DROPPED - 1))).view(np.float32)
    with np.errstate(invalid="ignore"):  # some are signalling NaNs
        return to_bytes(np.where(np.isinf(first), first, middle), exposure)


def fast_bytes(picture: Picture, exposure: float) -> Bytes:
    """Convert a float32 picture like `to_bytes`, with an error of at most one step of 255, in a tenth of the time."""
    keys = np.ascontiguousarray(picture, np.float32).view(np.uint32) >> DROPPED
    return table(exposure).take(keys)


@dataclass(frozen=True, eq=False)
class View:
    """A frame as it is shown.

    Parameters
    ----------
    pictures : mapping of str to (H, W, 3) 8-bit
        By `NOISY`, `DENOISED` and `REFERENCE`; the last one only if there is a reference.
    psnr, temporal : mapping of str to float
        Of noisy and denoised, compared with the reference; empty if there is none.
    """

    pictures: Mapping[str, Bytes]
    psnr: Mapping[str, float]
    temporal: Mapping[str, float]


class Screen:
    """Shows frames one after the other. A frame that follows the previous one has a temporal error, too."""

    def __init__(self) -> None:
        self._last: tuple[int, float, Mapping[str, Picture]] = NOTHING

    def show(self, index: int, item: Item, made: Filtered, exposure: float) -> View:
        """Show a frame, brightened by `exposure` stops; the shown pictures are measured (`svgf_cl.compare.metrics`)."""
        light = {NOISY: item.noisy, DENOISED: made.picture}
        if item.reference is not None:
            light[REFERENCE] = item.reference
        pictures = {name: fast_bytes(picture, exposure) for name, picture in light.items()}
        if item.reference is None:
            self._last = NOTHING
            return View(pictures, {}, {})
        shown = {name: picture.astype(np.float32) / np.float32(255) for name, picture in pictures.items()}
        errors = {name: psnr(shown[name], shown[REFERENCE]) for name in (NOISY, DENOISED)}
        last, brightness, before = self._last
        temporal: dict[str, float] = {}
        if abs(index - last) == 1 and brightness == exposure:
            wanted = before[REFERENCE], shown[REFERENCE]
            temporal = {n: temporal_error((before[n], shown[n]), wanted) for n in (NOISY, DENOISED)}
        self._last = (index, exposure, shown)
        return View(pictures, errors, temporal)
