"""Pictures for talks and papers: a scene by all rivals in a row, and below each a magnified piece."""

from __future__ import annotations

import io

import numpy as np
from PIL import Image

from svgf_cl.compare.page import Scene
from svgf_cl.io.display import Bytes
from svgf_cl.io.panels import GAP, LABEL_HEIGHT, magnified, side_by_side

WIDTH = 480  # pixels at most, of a panel


def figure(scene: Scene) -> Bytes:
    """All entries of a scene in a row, the noisy frame first and the reference last, and a piece of each."""
    pictures = {each.rival: decoded(each.picture) for each in scene.entries}
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


def decoded(file: bytes) -> Bytes:
    """The picture in a file (H, W, 3)."""
    return np.asarray(Image.open(io.BytesIO(file)).convert("RGB"))


def reduced(picture: Bytes) -> Bytes:
    """A picture no wider than a panel."""
    height, width, _ = picture.shape
    if width <= WIDTH:
        return picture
    return np.asarray(Image.fromarray(picture).resize((WIDTH, round(height * WIDTH / width)), Image.Resampling.LANCZOS))
