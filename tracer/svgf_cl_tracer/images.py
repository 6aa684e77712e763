"""Image files of every kind that a model's textures come in, as 8-bit pixels."""

from __future__ import annotations

import io
from collections.abc import Callable

import numpy as np
import PIL.Image
import PIL.ImageFile

from svgf_cl.errors import one_line

from .errors import SceneError
from .textures import Image

# Of all images of a model together, 1 GB in memory: a few kilobytes may stand for as much.
MAX_PIXELS = 2**28

# By Pillow's names; TGA last, as it alone is not told by its first bytes.
FORMATS = ("PNG", "JPEG", "WEBP", "TIFF", "BMP", "GIF", "DDS", "TGA")
LONGEST_SIGNATURE = 16

# PNG may name one colour that is transparent. Pillow leaves it in the file's units where it unpacks pixels to 8 bits.
KEY_SCALES = {"L;2": 85.0, "L;4": 17.0, "RGB;16B": 1.0 / 256.0}


class Images:
    """Pixels of a model's images, each decoded once however many materials show it."""

    def __init__(self) -> None:
        self._decoded: dict[str, Image] = {}
        self._room = MAX_PIXELS

    def pixels(self, name: str, read: Callable[[], bytes]) -> Image:
        """Pixels (h, w, 3), or (h, w, 4) where there is opacity, uint8, as they are stored: row 0 on top.

        Of 16 bits the upper 8 are kept. Colour profiles, gamma and the orientation in EXIF are left aside, as glTF
        has it.

        Parameters
        ----------
        name : str
            What errors call the image; the same name stands for the same image.
        read : callable
            Gives its file's bytes, when they are first wanted.

        Raises
        ------
        SceneError
            It is damaged or of another format, or the model's images are too large together.
        """
        if name not in self._decoded:
            try:
                image = _opened(read())
                self._room -= image.width * image.height
                if self._room < 0:
                    raise SceneError(f"expected at most {MAX_PIXELS} pixels in all images together, found more")
                self._decoded[name] = _unpacked(image)
            except SceneError as error:
                raise SceneError(f"image {name}: {error}") from error
            except Exception as error:  # Pillow raises whatever comes of a damaged file
                reason = one_line(error)
                raise SceneError(f"image {name}: expected a whole image, found a damaged one ({reason})") from error
        return self._decoded[name]


def _opened(encoded: bytes) -> PIL.ImageFile.ImageFile:
    """The image with its header read.

    `PIL.Image.open` would refuse images within the bound of here: its own is lower, and one for the whole process.
    """
    PIL.Image.init()
    for kind in FORMATS:
        factory, accepts = PIL.Image.OPEN[kind]
        if accepts is None or accepts(encoded[:LONGEST_SIGNATURE]):
            try:
                return factory(io.BytesIO(encoded), "")
            except SyntaxError:  # Pillow's word for another format
                continue
    raise SceneError(f"expected {', '.join(FORMATS[:-1])} or {FORMATS[-1]}, found another format or a damaged header")


def _unpacked(image: PIL.ImageFile.ImageFile) -> Image:
    if image.mode == "F" or image.mode.startswith("I"):
        return _sixteen_bits(image)
    scale = KEY_SCALES.get(str(image.tile[0][3])) if image.tile else None
    if scale is not None and "transparency" in image.info:
        key = image.info["transparency"]
        image.info["transparency"] = tuple(int(k * scale) for k in key) if isinstance(key, tuple) else int(key * scale)
    if image.has_transparency_data:
        return np.asarray(image.convert("RGBA"))
    if image.mode in ("1", "L"):
        return _grey(np.asarray(image.convert("L")))
    return np.asarray(image.convert("RGB"))


def _sixteen_bits(image: PIL.ImageFile.ImageFile) -> Image:
    """Grey of 16 bits, where `convert` would clip at 255."""
    values = np.asarray(image)
    if image.mode == "F" or values.min() < 0 or values.max() > 65535:
        raise SceneError("expected whole numbers of 8 or 16 bits, found others; convert it to PNG")
    grey = _grey((values >> 8).astype(np.uint8))
    if "transparency" not in image.info:
        return grey
    opacity = np.where(values == image.info["transparency"], 0, 255).astype(np.uint8)
    return np.dstack([grey, opacity])


def _grey(values: Image) -> Image:
    """The same in all three channels, without a copy."""
    return np.broadcast_to(values[..., None], (*values.shape, 3))
