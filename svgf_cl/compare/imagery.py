"""Makes the images of the page: a picture, its error map, an animated piece, and a row of pixels over time."""

from __future__ import annotations

import io
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from PIL import Image

from svgf_cl.compare.metrics import flip_map, why_no_flip
from svgf_cl.io.display import Bytes

QUALITY = 92  # of a WebP file: its errors are invisible next to noise
MAP_QUALITY = 75  # of an error map, which only shows where errors are
LARGEST = 16383  # pixels along a side of a WebP file
FPS = 8.0
ROW_HEIGHT = 6  # pixels that each frame takes in a profile
PIECES = 4  # pieces along each side of a picture


@dataclass(frozen=True)
class Piece:
    """A part of a picture.

    Parameters
    ----------
    rows, columns : slice
    """

    rows: slice
    columns: slice

    @property
    def crop(self) -> tuple[int, int, int, int]:
        """Left edge, top edge, width and height."""
        x, y = self.columns.start, self.rows.start
        return x, y, self.columns.stop - x, self.rows.stop - y

    @property
    def row(self) -> int:
        """The row through the middle, whose change over time is shown."""
        row: int = (self.rows.start + self.rows.stop) // 2
        return row

    def of(self, picture: Bytes) -> Bytes:
        """Return this part of a picture (H, W, 3)."""
        return picture[self.rows, self.columns]


def encoded(picture: Bytes, quality: int = QUALITY) -> bytes:
    """Return a picture (H, W, 3) as a WebP file, or as PNG if it is too large for WebP."""
    file = io.BytesIO()
    kind = "WEBP" if max(picture.shape) <= LARGEST else "PNG"
    Image.fromarray(picture).save(file, format=kind, quality=quality)
    return file.getvalue()


def error_map(shown: Bytes, wanted: Bytes) -> bytes | None:
    """Return FLIP's map of the difference of two pictures (H, W, 3) as a WebP file; None if FLIP is missing."""
    return None if why_no_flip() else encoded(flip_map(shown / 255.0, wanted / 255.0), MAP_QUALITY)


def clip(pieces: Sequence[Bytes]) -> bytes:
    """Return pieces of consecutive pictures as an animated WebP file; the page magnifies it."""
    first, *rest = map(Image.fromarray, pieces)
    file = io.BytesIO()
    first.save(
        file, format="WEBP", save_all=True, append_images=rest, duration=round(1000 / FPS), loop=0, quality=QUALITY
    )
    return file.getvalue()


def profile(rows: Sequence[Bytes]) -> bytes:
    """Return the same row (W, 3) of consecutive pictures, one below the other, as a WebP file."""
    return encoded(np.repeat(np.stack(rows), ROW_HEIGHT, axis=0))
