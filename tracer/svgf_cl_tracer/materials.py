"""Materials, and their look-up in compiled loops."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .compiled import compiled
from .errors import SceneError
from .motion import Track
from .textures import LINEAR, Image, Textures, texture_colour, texture_opacity
from .vec3 import Vec3, multiply, row
from .vectors import Float64

Colour = tuple[float, float, float]


@dataclass(frozen=True, eq=False)
class Material:
    """A surface, the same on both sides: glTF's metallic-roughness model or smooth glass; it may emit light.

    Parameters
    ----------
    base_colour : (r, g, b)
        Linear, 0..1: the diffuse reflectance of a dielectric, the reflectance of a metal at normal incidence, or the
        share of light that glass lets through.
    emission : (r, g, b)
        Linear radiance, >= 0.
    base_texture : (h, w, 3) or (h, w, 4) uint8, optional
        sRGB image that multiplies `base_colour`; its fourth channel is the opacity that `alpha_cutoff` tests.
    emission_texture : (h, w, 3) or (h, w, 4) uint8, optional
        sRGB image that multiplies `emission`; a fourth channel is ignored.
    metallic : float
        0 (dielectric) to 1 (metal).
    roughness : float
        Perceptual roughness, 0 (mirror) to 1: the GGX width is its square.
    ior : float
        Refractive index of a dielectric, >= 1. At 1 the coat reflects nothing: a Lambertian surface.
    transmissive : bool
        Smooth glass: light is reflected or refracted at it, and never scattered.
    alpha_cutoff : float, optional
        Rays pass through where the opacity is below this; without it, every point is solid.
    two_sided : bool
        Emit from the back, too.
    brightness : Track of (factor,), optional
        Factor of `emission` over time, for a lamp that is dimmed or switched.

    Raises
    ------
    SceneError
        If a number is not finite or is out of its range.
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
        if not all(0.0 <= channel <= 1.0 for channel in self.base_colour):
            raise SceneError(f"material: expected a colour in 0..1, got {self.base_colour}")
        if not (np.isfinite(self.emission).all() and min(self.emission) >= 0.0):
            raise SceneError(f"material: expected a finite emission >= 0, got {self.emission}")
        for name in ("metallic", "roughness", "alpha_cutoff"):
            if (value := getattr(self, name)) is not None and not 0.0 <= value <= 1.0:
                raise SceneError(f"material: expected {name} in 0..1, got {value}")
        for name in ("base_texture", "emission_texture"):
            if (image := getattr(self, name)) is not None:
                _check_image(name, image)
        if not 1.0 <= self.ior < np.inf:
            raise SceneError(f"material: expected a finite refractive index >= 1, got {self.ior}")

    def emission_at(self, time: float) -> Float64:
        """Radiance (3,) at `time` in seconds, averaged over the texture."""
        mean = np.array(self.emission) * self.brightness_at(time)
        if self.emission_texture is not None:
            mean *= LINEAR[self.emission_texture[..., :3]].mean((0, 1), np.float64)
        return mean

    def brightness_at(self, time: float) -> float:
        """The factor of `emission` at `time` in seconds, >= 0."""
        return 1.0 if self.brightness is None else max(float(self.brightness.at(time)[0]), 0.0)


def _check_image(name: str, image: Image) -> None:
    if image.dtype != np.uint8 or image.ndim != 3 or image.shape[2] not in (3, 4) or not image.size:
        raise SceneError(f"material: expected a {name} (h, w, 3) or (h, w, 4) uint8, got {image.shape} {image.dtype}")


class Materials(NamedTuple):
    """The materials of a scene as arrays; the number of a missing texture is -1."""

    base_colour: Float64
    base_texture: NDArray[np.int64]
    emission: Float64
    emission_texture: NDArray[np.int64]
    metallic: Float64
    roughness: Float64
    ior: Float64
    transmissive: NDArray[np.bool_]
    alpha_cutoff: Float64
    two_sided: NDArray[np.bool_]
    textures: Textures

    @classmethod
    def of(cls, materials: Sequence[Material]) -> Materials:
        """The tables of these materials; each image is stored once."""
        images: dict[int, Image] = {}
        for material in materials:
            for image in (material.base_texture, material.emission_texture):
                if image is not None:
                    images.setdefault(id(image), image)
        number = {key: index for index, key in enumerate(images)}
        return cls(
            np.array([m.base_colour for m in materials], np.float64),
            np.array([number.get(id(m.base_texture), -1) for m in materials], np.int64),
            np.array([m.emission for m in materials], np.float64),
            np.array([number.get(id(m.emission_texture), -1) for m in materials], np.int64),
            np.array([m.metallic for m in materials], np.float64),
            np.array([m.roughness for m in materials], np.float64),
            np.array([m.ior for m in materials], np.float64),
            np.array([m.transmissive for m in materials], np.bool_),
            np.array([m.alpha_cutoff or 0.0 for m in materials], np.float64),
            np.array([m.two_sided for m in materials], np.bool_),
            Textures.of(list(images.values())),
        )


@compiled
def base_colour(materials: Materials, material: int, u: float, v: float) -> Vec3:
    """The base colour of a material at texture coordinates (u, v)."""
    colour = row(materials.base_colour, material)
    texture = materials.base_texture[material]
    return multiply(colour, texture_colour(materials.textures, texture, u, v)) if texture >= 0 else colour


@compiled
def emitted_radiance(materials: Materials, material: int, u: float, v: float) -> Vec3:
    """The radiance that a material emits at texture coordinates (u, v)."""
    radiance = row(materials.emission, material)
    texture = materials.emission_texture[material]
    return multiply(radiance, texture_colour(materials.textures, texture, u, v)) if texture >= 0 else radiance


@compiled
def is_solid(materials: Materials, material: int, u: float, v: float) -> bool:
    """Whether a material stops a ray at texture coordinates (u, v)."""
    texture = materials.base_texture[material]
    cutoff = float(materials.alpha_cutoff[material])
    return texture < 0 or cutoff <= 0.0 or texture_opacity(materials.textures, texture, u, v) >= cutoff
