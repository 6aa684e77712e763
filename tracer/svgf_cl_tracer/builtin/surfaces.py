"""The materials that several built-in scenes share."""

from __future__ import annotations

from ..materials import Colour, Material
from ..textures import Image

GLASS = Material((0.98, 0.99, 0.99), transmissive=True, roughness=0.0, ior=1.5)


def lamp(*emission: float) -> Material:
    """A black surface that emits the radiance (r, g, b)."""
    red, green, blue = emission
    return Material((0.0, 0.0, 0.0), emission=(red, green, blue))


def painted(texture: Image) -> Material:
    """A matt surface that shows a texture."""
    return Material(base_texture=texture)


def glazed(colour: Colour, roughness: float = 0.3) -> Material:
    """A glossy coat over a colour: ceramics, varnish, fruit."""
    return Material(colour, roughness=roughness, ior=1.5)


def metal(colour: Colour, roughness: float) -> Material:
    """Polished or brushed metal."""
    return Material(colour, metallic=1.0, roughness=roughness)
