"""Textures of a file: their images, and where on a surface they lie."""

from __future__ import annotations

import io
import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import PIL.Image

from svgf_cl_tracer.errors import SceneError
from svgf_cl_tracer.meshes import Images
from svgf_cl_tracer.textures import Image
from svgf_cl_tracer.vectors import Float64

from .extensions import TEXTURE_TRANSFORM, WEBP
from .file import Gltf
from .resources import resource


@dataclass(frozen=True)
class Coordinates:
    """Which of a mesh's sets of texture coordinates a texture takes, and how it moves them (KHR_texture_transform).

    Parameters
    ----------
    number : int
        Of the set.
    offset, scale : (u, v)
    rotation : float
        Radians, counter-clockwise.
    """

    number: int = 0
    offset: tuple[float, float] = (0.0, 0.0)
    scale: tuple[float, float] = (1.0, 1.0)
    rotation: float = 0.0

    @classmethod
    def of(cls, texture: dict[str, Any]) -> Coordinates:
        """Those of a textureInfo of the file."""
        transform = texture.get("extensions", {}).get(TEXTURE_TRANSFORM, {})
        (u, v), (width, height) = transform.get("offset", cls.offset), transform.get("scale", cls.scale)
        number = transform.get("texCoord", texture.get("texCoord", cls.number))
        return cls(int(number), (u, v), (width, height), float(transform.get("rotation", cls.rotation)))

    @property
    def attribute(self) -> str:
        """What the set is called in a primitive."""
        return f"TEXCOORD_{self.number}"

    def applied(self, uv: Float64) -> Float64:
        """Texture coordinates (V, 2), v up, for those of the file, whose v points down."""
        u, v = uv[:, 0] * self.scale[0], uv[:, 1] * self.scale[1]
        cosine, sine = math.cos(self.rotation), math.sin(self.rotation)
        # Counter-clockwise as seen, v pointing down: the specification's example, not its matrix.
        return np.stack(
            [cosine * u + sine * v + self.offset[0], 1.0 - (cosine * v - sine * u + self.offset[1])], axis=1
        )


class Textures:
    """The images of one file, each opened once.

    Parameters
    ----------
    gltf : Gltf
    """

    def __init__(self, gltf: Gltf) -> None:
        self._gltf = gltf
        self._opened: dict[int, PIL.Image.Image] = {}
        self._images = Images()

    def pixels(self, texture: dict[str, Any] | None, mode: str) -> Image | None:
        """The image of a textureInfo as (h, w, channels) with the channels of `mode`, such as ``"RGB"``; None for none.

        Raises
        ------
        SceneError
            It cannot be read.
        """
        if texture is None:
            return None
        source = self._source(texture["index"])
        try:
            if source not in self._opened:
                self._opened[source] = PIL.Image.open(io.BytesIO(self._bytes(source)))
            return self._images.pixels(self._opened[source], mode)
        except SceneError as error:
            raise SceneError(f"images[{source}]: {error}") from error
        except Exception as error:  # Pillow raises whatever comes of what a file holds
            raise SceneError(f"images[{source}]: expected PNG, JPEG or WebP, cannot be read ({error})") from error

    def _source(self, index: Any) -> int:
        """The number of the image that a texture shows."""
        texture = self._gltf.item("textures", index)
        source: int | None = texture.get("extensions", {}).get(WEBP, texture).get("source")
        if source is None:
            known = ", ".join(texture.get("extensions", {})) or "no extension"
            raise SceneError(f"textures[{index}]: expected an image that can be read, found none ({known})")
        return source

    def _bytes(self, index: int) -> bytes:
        image = self._gltf.item("images", index)
        return (
            resource(self._gltf.path.parent, image["uri"])
            if "uri" in image
            else bytes(self._gltf.view(image["bufferView"]))
        )
