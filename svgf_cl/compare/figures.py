"""Makes figures for talks and papers: a scene by all rivals in a row, and a magnified piece below each."""

from __future__ import annotations

import io

import numpy as np
from PIL import Image

from svgf_cl.compare.page import Scene
from svgf_cl.io.display import Bytes
from svgf_cl.io.panels import GAP, LABEL_HEIGHT, magnified, side_by_side

WIDTH = 480  # pixels, of a panel, at most
LONGEST = 40  # characters in a file's name, up to four bytes each


def figure(scene: Scene) -> Bytes:
    """Return the noisy frame, all filters and the reference in a row, with a magnified piece below each."""
    entries = sorted(scene.entries, key=lambda each: (each.rival != scene.noisy, each.rival == scene.reference))
    pictures = {each.rival: decoded(each.picture) for each in entries}
    panels = {name: reduced(picture) for name, picture in pictures.items()}
    whole = side_by_side(panels)
    if scene.crop is None:
        return whole
    x, y, width, height = scene.crop
    shape = next(iter(panels.values())).shape
    fitting = (round(shape[1] * height / width), shape[1], 3)
    pieces = {name: magnified(picture[y : y + height, x : x + width], fitting) for name, picture in pictures.items()}
    gap = np.zeros_like(whole[:GAP])
    return np.concatenate([whole, gap, side_by_side(pieces)[LABEL_HEIGHT:]])


def file_name(number: int, name: str) -> str:
    """Return the file name of a scene's figure: its number, and its name in characters that any system accepts."""
    safe = "".join(char if char.isalnum() or char in "-_" else "_" for char in name)
    return f"{number:02d}.{safe[:LONGEST]}.png"


def decoded(file: bytes) -> Bytes:
    """Return the picture in a file's bytes, (H, W, 3)."""
    return np.asarray(Image.open(io.BytesIO(file)).convert("RGB"))


def reduced(picture: Bytes) -> Bytes:
    """Return the picture, scaled down if it is wider than a panel."""
    height, width, _ = picture.shape
    if width <= WIDTH:
        return picture
    return np.asarray(
        Image.fromarray(picture).resize((WIDTH, max(1, round(height * WIDTH / width))), Image.Resampling.LANCZOS)
    )
