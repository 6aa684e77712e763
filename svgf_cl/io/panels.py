"""Makes pictures to compare results: labelled panels in a row or sheet, a magnified piece, an animated preview."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from svgf_cl.io.atomic import written_whole
from svgf_cl.io.display import Bytes

LABEL_HEIGHT = 28
FONT_SIZE = 16
GAP = 4


def write_preview(path: Path, pictures: Iterable[Bytes], fps: float = 12.0) -> None:
    """Write (H, W, 3) 8-bit pictures as a looping animated WebP, completely or not at all."""
    first, *rest = (Image.fromarray(picture) for picture in pictures)
    with written_whole(path) as aside:
        first.save(
            aside, format="WEBP", save_all=True, append_images=rest, duration=round(1000 / fps), loop=0, quality=92
        )


def side_by_side(panels: Mapping[str, Bytes]) -> Bytes:
    """Put panels of one size in a row, each below its label."""
    height, width, _ = next(iter(panels.values())).shape
    sheet = Image.new("RGB", (len(panels) * (width + GAP) - GAP, height + LABEL_HEIGHT), "black")
    draw = ImageDraw.Draw(sheet)
    for index, (label, picture) in enumerate(panels.items()):
        left = index * (width + GAP)
        centre = left + width / 2, LABEL_HEIGHT / 2
        draw.text(centre, label, fill="white", font=_font(label, width), anchor="mm")
        sheet.paste(Image.fromarray(picture), (left, LABEL_HEIGHT))
    return np.asarray(sheet)


def contact_sheet(panels: Mapping[str, Bytes]) -> Bytes:
    """Put panels of one size in a sheet with about as many rows as columns, each below its label."""
    labels, columns = list(panels), math.ceil(math.sqrt(len(panels)))
    starts = range(0, len(labels), columns)
    rows = [side_by_side({label: panels[label] for label in labels[start : start + columns]}) for start in starts]
    return np.concatenate([np.pad(row, ((0, GAP), (0, rows[0].shape[1] - row.shape[1]), (0, 0))) for row in rows])


def still(panels: Mapping[str, Bytes]) -> Bytes:
    """Put labelled panels in a row, and below each a magnified piece: the one where the last two differ most."""
    *_, (_, tested), (_, reference) = panels.items()
    piece = worst_piece(tested, reference)
    crops = {label: magnified(picture[piece], picture.shape) for label, picture in panels.items()}
    gap = np.zeros_like(side_by_side(panels)[:GAP])
    return np.concatenate([side_by_side(panels), gap, side_by_side(crops)[LABEL_HEIGHT:]])


def worst_piece(tested: Bytes, reference: Bytes, pieces: int = 4) -> tuple[slice, slice]:
    """Return the tile, of ``pieces * pieces`` equal ones, with the greatest squared error."""
    height, width = (max(1, n // pieces) for n in tested.shape[:2])
    rows, columns = (range(n // size) for n, size in zip(tested.shape, (height, width), strict=False))
    error = np.square(tested.astype(np.float64) - reference).sum(axis=-1)
    tiles = [np.s_[y * height : (y + 1) * height, x * width : (x + 1) * width] for y in rows for x in columns]
    return max(tiles, key=lambda tile: float(error[tile].sum()))


def _font(label: str, width: int) -> ImageFont.ImageFont | ImageFont.FreeTypeFont:
    """Return the usual font, or a smaller one if `label` would not fit into `width` pixels."""
    length = ImageFont.load_default(FONT_SIZE).getlength(label)
    fitting = 0.95 * width / max(length, 1.0) * FONT_SIZE  # a little less, as letters do not shrink evenly
    return ImageFont.load_default(max(1.0, min(FONT_SIZE, fitting)))


def magnified(picture: Bytes, shape: tuple[int, ...]) -> Bytes:
    """Enlarge `picture` to the height and width of `shape`, with each pixel as a sharp block."""
    return np.asarray(Image.fromarray(picture).resize((shape[1], shape[0]), Image.Resampling.NEAREST))
