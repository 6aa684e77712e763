"""Textures of a file: their images and their texture coordinates."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from svgf_cl_tracer.errors import SceneError
from svgf_cl_tracer.images import Images
from svgf_cl_tracer.textures import Image
from svgf_cl_tracer.vectors import Float64

from .extensions import TEXTURE_TRANSFORM, WEBP
from .file import Gltf
from .resources import resource


@dataclass(frozen=True)
class Coordinates:
    """The set of texture coordinates that a texture uses, and their transform (KHR_texture_transform).

    Parameters
    ----------
    number : int
        The number of the set.
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
        """The coordinates of a textureInfo of the file."""
        transform = texture.get("extensions", {}).get(TEXTURE_TRANSFORM, {})
        (u, v), (width, height) = transform.get("offset", cls.offset), transform.get("scale", cls.scale)
        number = transform.get("texCoord", texture.get("texCoord", cls.number))
        return cls(int(number), (u, v), (width, height), float(transform.get("rotation", cls.rotation)))

    @property
    def attribute(self) -> str:
        """The name of the set in a primitive."""
        return f"TEXCOORD_{self.number}"

    def applied(self, uv: Float64) -> Float64:
        """Convert texture coordinates (V, 2) of the file, whose v points down, to transformed ones with v up."""
        u, v = uv[:, 0] * self.scale[0], uv[:, 1] * self.scale[1]
        cosine, sine = math.cos(self.rotation), math.sin(self.rotation)
        # Counter-clockwise as seen, with v down: this follows the specification's example, not its matrix.
        return np.stack(
            [cosine * u + sine * v + self.offset[0], 1.0 - (cosine * v - sine * u + self.offset[1])], axis=1
        )


class Textures:
    """The images of one file.

    Parameters
    ----------
    gltf : Gltf
    """

    def __init__(self, gltf: Gltf) -> None:
        self._gltf, self._images = gltf, Images()

    def pixels(self, texture: dict[str, Any]) -> Image:
        """The image (h, w, 3 or 4) of a textureInfo; `SceneError` if it cannot be read."""
        source = self._source(texture["index"])
        return self._images.pixels(str(source), lambda: self._bytes(source))

    def _source(self, index: Any) -> int:
        """The number of the image of a texture."""
        texture = self._gltf.item("textures", index)
        holder = texture.get("extensions", {}).get(WEBP, texture)
        if "source" not in holder:
            known = ", ".join(texture.get("extensions", {})) or "nothing"
            raise SceneError(f"textures[{index}]: expected the source of an image, found {known}")
        source: int = holder["source"]
        return source

    def _bytes(self, index: int) -> bytes:
        image = self._gltf.item("images", index)
        if "uri" not in image:
            return bytes(self._gltf.view(image.get("bufferView")))
        try:
            return resource(self._gltf.path.parent, image["uri"])
        except SceneError as error:
            raise SceneError(f"images[{index}].uri: {error}") from error
