"""Pictures for talks and papers: a scene by all rivals in a row, and below each a magnified piece."""

from __future__ import annotations

import io

import numpy as np
from PIL import Image

from svgf_cl.compare.page import Scene
from svgf_cl.io.display import Bytes
from svgf_cl.io.panels import GAP, LABEL_HEIGHT, magnified, side_by_side

WIDTH = 480  # pixels at most, of a panel
LONGEST = 40  # characters of a name, of up to four bytes each


def figure(scene: Scene) -> Bytes:
    """The noisy frame, all filters and the reference in a row, and below each a magnified piece."""
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
    """What to call the figure of a scene: its number, and of its name what any system takes."""
    safe = "".join(char if char.isalnum() or char in "-_" else "_" for char in name)
    return f"{number:02d}.{safe[:LONGEST]}.png"


def decoded(file: bytes) -> Bytes:
    """The picture in a file (H, W, 3)."""
    return np.asarray(Image.open(io.BytesIO(file)).convert("RGB"))


def reduced(picture: Bytes) -> Bytes:
    """A picture no wider than a panel."""
    height, width, _ = picture.shape
    if width <= WIDTH:
        return picture
    return np.asarray(
        Image.fromarray(picture).resize((WIDTH, max(1, round(height * WIDTH / width))), Image.Resampling.LANCZOS)
    )
