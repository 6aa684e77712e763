"""Materials of a file: the core's metallic-roughness model, and the extensions that the tracer can show."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from svgf_cl_tracer.errors import SceneError
from svgf_cl_tracer.materials import Material
from svgf_cl_tracer.meshes import colour
from svgf_cl_tracer.textures import Image

from .file import Gltf, name_of
from .textures import Coordinates, Textures

BLACK, WHITE = (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)

# Defaults of the core specification and of KHR_materials_ior.
CUTOFF, IOR = 0.5, 1.5

# The largest index; a coat that reflects everything would not be a material.
MAX_REFLECTANCE = 0.98


# The material of a primitive that has none; vertex colours multiply it.
UNNAMED, UNNAMED_COLOURED = Material(), Material(WHITE)


class Materials:
    """The materials of one file, each made once.

    Parameters
    ----------
    gltf : Gltf
    """

    def __init__(self, gltf: Gltf) -> None:
        self._gltf, self._textures = gltf, Textures(gltf)
        self._made: dict[int, Material | None] = {}

    def of(self, index: int | None, *, coloured: bool = False) -> tuple[str, Material | None]:
        """The name and the material number `index`, for a mesh that may have colours.

        None if the material is invisible.
        """
        if index is None:
            return "", UNNAMED_COLOURED if coloured else UNNAMED
        document = self._gltf.item("materials", index)
        if index not in self._made:
            self._made[index] = self._make(document)
        return name_of(document), self._made[index]

    def coordinates(self, index: int | None) -> Coordinates:
        """The texture coordinates of material number `index`: those of its base colour, or else of its emission."""
        document = {} if index is None else self._gltf.item("materials", index)
        return Coordinates.of(base_texture(document) or document.get("emissiveTexture") or {})

    def _make(self, document: dict[str, Any]) -> Material | None:
        base = document.get("pbrMetallicRoughness", {})
        *factor, opacity = base.get("baseColorFactor", (*WHITE, 1.0))
        cutoff = _cutoff(document)
        if cutoff is not None and opacity < cutoff:
            return None
        strength = _extension(document, "emissive_strength").get("emissiveStrength", 1.0)
        rough, metal = _means(self._pixels(document, "metallicRoughnessTexture"))
        texture = self._pixels(document, "baseColorTexture")
        transmissive = _extension(document, "transmission").get("transmissionFactor", 0.0) >= CUTOFF
        return Material(
            colour(factor),
            colour(np.array(document.get("emissiveFactor", BLACK)) * strength),
            texture,
            self._pixels(document, "emissiveTexture"),
            metallic=base.get("metallicFactor", 1.0) * metal,
            roughness=base.get("roughnessFactor", 1.0) * rough,
            ior=_extension(document, "ior").get("ior", IOR) if transmissive else _coat(document),
            transmissive=transmissive,
            alpha_cutoff=cutoff / opacity if cutoff and texture is not None else None,
        )

    def _pixels(self, document: dict[str, Any], name: str) -> Image | None:
        """The image of a material's texture `name`; None if it has none."""
        texture = (document if name in document else document.get("pbrMetallicRoughness", {})).get(name)
        try:
            return None if texture is None else self._textures.pixels(texture)
        except SceneError as error:
            raise SceneError(f"the {name} of material {document.get('name')!r} cannot be read: {error}") from error


def base_texture(document: dict[str, Any]) -> dict[str, Any] | None:
    """The textureInfo of a material's base colour; None if it has none."""
    texture: dict[str, Any] | None = document.get("pbrMetallicRoughness", {}).get("baseColorTexture")
    return texture


def _extension(document: dict[str, Any], name: str) -> dict[str, Any]:
    extensions = document.get("extensions") or {}
    return extensions.get(f"KHR_materials_{name}") or {}


def _cutoff(document: dict[str, Any]) -> float | None:
    """The opacity below which there is a hole; None if the material is solid. Blended materials get one half."""
    mode = document.get("alphaMode", "OPAQUE")
    if mode == "OPAQUE":
        return None
    return float(document.get("alphaCutoff", CUTOFF)) if mode == "MASK" else CUTOFF


def _coat(document: dict[str, Any]) -> float:
    """The refractive index that has the same reflectance at normal incidence as the material.

    KHR_materials_ior has an index, where 0 means a mirror; KHR_materials_specular has a factor and a colour.
    """
    ior, specular = _extension(document, "ior").get("ior", IOR), _extension(document, "specular")
    tint = np.mean(specular.get("specularColorFactor", WHITE))
    reflectance = min(((ior - 1.0) / (ior + 1.0)) ** 2 * tint, 1.0) * specular.get("specularFactor", 1.0)
    root = math.sqrt(min(reflectance, MAX_REFLECTANCE))
    return float((1.0 + root) / (1.0 - root))


def _means(image: Image | None) -> tuple[float, float]:
    """Roughness and metalness, 0..1: the means of the second and third channel of their texture."""
    if image is None:
        return 1.0, 1.0
    _, rough, metal = image[..., :3].mean((0, 1)) / 255.0
    return float(rough), float(metal)
