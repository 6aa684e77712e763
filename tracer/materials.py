"""Materials: Lambertian reflection and emission, each a factor times an optional texture."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .errors import SceneError
from .textures import LINEAR, Image, Textures
from .vectors import Float32

Colour = tuple[float, float, float]


@dataclass(frozen=True, eq=False)
class Material:
    """A Lambertian surface, the same on both sides, that may emit light from its front.

    Parameters
    ----------
    base_colour : (r, g, b)
        Linear reflectance, 0..1.
    emission : (r, g, b)
        Linear radiance, >= 0.
    base_texture, emission_texture : (h, w, 3) uint8, optional
        sRGB images that multiply the two.

    Raises
    ------
    SceneError
        A colour is not finite or below 0.
    """

    base_colour: Colour = (0.8, 0.8, 0.8)
    emission: Colour = (0.0, 0.0, 0.0)
    base_texture: Image | None = None
    emission_texture: Image | None = None

    def __post_init__(self) -> None:
        for name, colour in (("colour", self.base_colour), ("emission", self.emission)):
            if not (np.isfinite(colour).all() and min(colour) >= 0.0):
                raise SceneError(f"material: expected a finite {name} >= 0, got {colour}")

    def mean_emission(self) -> NDArray[np.float64]:
        """Radiance (3,) averaged over the texture."""
        if self.emission_texture is None:
            return np.array(self.emission)
        texture: NDArray[np.float64] = LINEAR[self.emission_texture].mean((0, 1), np.float64)
        return np.array(self.emission) * texture


class MaterialTable:
    """The materials of a scene as arrays, looked up by index for a batch of hits."""

    def __init__(self, materials: Sequence[Material]) -> None:
        images: dict[int, Image] = {}
        for material in materials:
            for image in (material.base_texture, material.emission_texture):
                if image is not None:
                    images.setdefault(id(image), image)
        number = {key: index for index, key in enumerate(images)}
        self._textures = Textures(list(images.values()))
        self._base = _Property(
            [m.base_colour for m in materials], [number.get(id(m.base_texture), -1) for m in materials]
        )
        self._emission = _Property(
            [m.emission for m in materials], [number.get(id(m.emission_texture), -1) for m in materials]
        )

    def albedo(self, material: NDArray[np.int32], uv: Float32) -> Float32:
        """Reflectance (3, N) of the materials `material` (N,) at texture coordinates `uv` (2, N)."""
        return self._base.evaluate(self._textures, material, uv)

    def emission(self, material: NDArray[np.int32], uv: Float32) -> Float32:
        """Emitted radiance (3, N)."""
        return self._emission.evaluate(self._textures, material, uv)


class _Property:
    """A colour factor and a texture number (-1 = none) for each material."""

    def __init__(self, factors: Sequence[Colour], textures: Sequence[int]) -> None:
        self._factors = np.array(factors, np.float32).reshape(-1, 3).T.copy()
        self._texture_of = np.array(textures, np.int32)

    def evaluate(self, textures: Textures, material: NDArray[np.int32], uv: Float32) -> Float32:
        values: Float32 = self._factors.take(material, axis=1)
        if (self._texture_of < 0).all():
            return values
        texture = self._texture_of.take(material)
        textured = np.flatnonzero(texture >= 0)
        if textured.size:
            texels = textures.sample(texture.take(textured), uv.take(textured, axis=1))
            for channel in range(3):
                values[channel, textured] *= texels[channel]
        return values
