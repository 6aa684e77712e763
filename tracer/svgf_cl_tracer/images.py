"""Decodes images of all kinds that models use as textures, to 8-bit pixels."""

from __future__ import annotations

import io
from collections.abc import Callable

import numpy as np
import PIL.Image
import PIL.ImageFile

from svgf_cl.errors import one_line

from .errors import SceneError
from .textures import Image

# The most pixels of all images of a model together, 1 GB in memory: a file of a few kilobytes may decode to as much.
MAX_PIXELS = 2**28

# Pillow's names of formats; TGA is last, because it cannot be recognised by its first bytes.
FORMATS = ("PNG", "JPEG", "WEBP", "TIFF", "BMP", "GIF", "DDS", "TGA")
LONGEST_SIGNATURE = 16

# A PNG may define one colour as transparent. Pillow keeps it in the file's units when it unpacks pixels to 8 bits.
KEY_SCALES = {"L;2": 85.0, "L;4": 17.0, "RGB;16B": 1.0 / 256.0}


class Images:
    """The pixels of a model's images; each image is decoded once, however many materials use it."""

    def __init__(self) -> None:
        self._decoded: dict[str, Image] = {}
        self._room = MAX_PIXELS

    def pixels(self, name: str, read: Callable[[], bytes]) -> Image:
        """Pixels (h, w, 3), or (h, w, 4) if there is opacity, uint8, as they are stored, with row 0 on top.

        Of 16 bits the upper 8 are kept. Colour profiles, gamma and EXIF orientation are ignored, as glTF demands.

        Parameters
        ----------
        name : str
            The image's name in errors; the same name means the same image.
        read : callable
            Returns the bytes of the file when they are first needed.

        Raises
        ------
        SceneError
            If it is damaged or of another format, or if the model's images are too large together.
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
            except Exception as error:  # Pillow raises errors of any kind for damaged files
                reason = one_line(error)
                raise SceneError(f"image {name}: expected a whole image, found a damaged one ({reason})") from error
        return self._decoded[name]


def _opened(encoded: bytes) -> PIL.ImageFile.ImageFile:
    """Open the image and read its header.

    `PIL.Image.open` would refuse some images that are allowed here, because it has a lower limit, for the whole
    process.
    """
    PIL.Image.init()
    for kind in FORMATS:
        factory, accepts = PIL.Image.OPEN[kind]
        if accepts is None or accepts(encoded[:LONGEST_SIGNATURE]):
            try:
                return factory(io.BytesIO(encoded), "")
            except SyntaxError:  # Pillow's error for another format
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
    """Convert grey of 16 bits, which `convert` would clip at 255."""
    values = np.asarray(image)
    if image.mode == "F" or values.min() < 0 or values.max() > 65535:
        raise SceneError("expected whole numbers of 8 or 16 bits, found others; convert it to PNG")
    grey = _grey((values >> 8).astype(np.uint8))
    if "transparency" not in image.info:
        return grey
    opacity = np.where(values == image.info["transparency"], 0, 255).astype(np.uint8)
    return np.dstack([grey, opacity])


def _grey(values: Image) -> Image:
    """The grey values in all three channels, without a copy."""
    return np.broadcast_to(values[..., None], (*values.shape, 3))
