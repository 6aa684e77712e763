"""Materials: Lambertian reflection and emission, each a factor times an optional texture."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .errors import SceneError
from .motion import Track
from .textures import LINEAR, Image, Textures
from .vectors import Float32

Colour = tuple[float, float, float]


@dataclass(frozen=True, eq=False)
class Material:
    """A surface, the same on both sides: glTF's metallic-roughness model, or smooth glass, that may emit light.

    Parameters
    ----------
    base_colour : (r, g, b)
        Linear, 0..1: what a dielectric reflects diffusely, a metal reflects at normal incidence, or glass lets through.
    emission : (r, g, b)
        Linear radiance, >= 0.
    base_texture : (h, w, 3) or (h, w, 4) uint8, optional
        sRGB image that multiplies `base_colour`; its fourth channel is the opacity that `alpha_cutoff` tests.
    emission_texture : (h, w, 3) uint8, optional
        sRGB image that multiplies `emission`.
    metallic : float
        0 (dielectric) to 1 (metal).
    roughness : float
        Perceptual roughness, 0 (mirror) to 1: the GGX width is its square.
    ior : float
        Refractive index of a dielectric, >= 1. At 1 nothing is reflected at its coat: a Lambertian surface.
    transmissive : bool
        Smooth glass: light is reflected or refracted at it, and never scattered.
    alpha_cutoff : float, optional
        Rays pass through where the opacity is below; every point is solid where absent.
    two_sided : bool
        Emit from the back too.
    brightness : Track of (factor,), optional
        Factor of `emission` over time: a lamp that is dimmed or switched.

    Raises
    ------
    SceneError
        A number is not finite or out of its range.
    """

    base_colour: Colour = (0.8, 0.8, 0.8)
    emission: Colour = (0.0, 0.0, 0.0)
    base_texture: Image | None = None
    emission_texture: Image | None = None
    metallic: float = 0.0
    roughness: float = 1.0
    ior: float = 1.0
    transmissive: bool = False
    alpha_cutoff: float | None = None
    two_sided: bool = False
    brightness: Track | None = None

    def __post_init__(self) -> None:
        for name, colour in (("colour", self.base_colour), ("emission", self.emission)):
            if not (np.isfinite(colour).all() and min(colour) >= 0.0):
                raise SceneError(f"material: expected a finite {name} >= 0, got {colour}")
        for name, value in (("metallic", self.metallic), ("roughness", self.roughness)):
            if not 0.0 <= value <= 1.0:
                raise SceneError(f"material: expected {name} in 0..1, got {value}")
        if not 1.0 <= self.ior < np.inf:
            raise SceneError(f"material: expected a finite refractive index >= 1, got {self.ior}")

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
