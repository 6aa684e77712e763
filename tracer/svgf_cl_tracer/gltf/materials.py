"""Materials of a file: the core's metallic-roughness model with the extensions that the tracer can show."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import trimesh

from svgf_cl_tracer.errors import SceneError
from svgf_cl_tracer.materials import Material
from svgf_cl_tracer.meshes import Images, colour, unnamed_material
from svgf_cl_tracer.textures import Image

from .file import name_of

BLACK, WHITE = (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)

# What the core specification and KHR_materials_ior have where a file says nothing.
CUTOFF, IOR = 0.5, 1.5

# A coat that reflects all is no material: an index near 200.
MAX_REFLECTANCE = 0.98


class Materials:
    """The materials of one file, each made once.

    Parameters
    ----------
    documents : list of dict
        Their JSON; the meshes asked about call them by their index.
    """

    def __init__(self, documents: list[dict[str, Any]]) -> None:
        self._documents = documents
        self._made: dict[int, Material | None] = {}
        self._images = Images()

    def of(self, mesh: trimesh.Trimesh) -> tuple[str, Material | None]:
        """Name and material of `mesh`; None where nothing of it can be seen."""
        source = getattr(mesh.visual, "material", None)
        if source is None or source.name is None:
            return "", unnamed_material(mesh)
        index = int(source.name)
        document = self._documents[index]
        if index not in self._made:
            self._made[index] = self._make(document, source)
        return name_of(document), self._made[index]

    def _make(self, document: dict[str, Any], source: Any) -> Material | None:
        """The material of `document`, with the images that trimesh hung on `source`."""
        base = document.get("pbrMetallicRoughness", {})
        for name, where in (("baseColorTexture", base), ("emissiveTexture", document)):
            if name in where and getattr(source, name) is None:
                raise SceneError(f"the {name} of material {document.get('name')!r} cannot be read")
        *factor, opacity = base.get("baseColorFactor", (*WHITE, 1.0))
        cutoff = _cutoff(document)
        if cutoff is not None and opacity < cutoff:
            return None
        strength = _extension(document, "emissive_strength").get("emissiveStrength", 1.0)
        rough, metal = _means(self._images.pixels(source.metallicRoughnessTexture, "RGB"))
        transmissive = _extension(document, "transmission").get("transmissionFactor", 0.0) >= CUTOFF
        return Material(
            colour(factor),
            colour(np.array(document.get("emissiveFactor", BLACK)) * strength),
            self._images.pixels(source.baseColorTexture, "RGB" if cutoff is None else "RGBA"),
            self._images.pixels(source.emissiveTexture, "RGB"),
            metallic=base.get("metallicFactor", 1.0) * metal,
            roughness=base.get("roughnessFactor", 1.0) * rough,
            ior=_extension(document, "ior").get("ior", IOR) if transmissive else _coat(document),
            transmissive=transmissive,
            alpha_cutoff=None if cutoff is None or source.baseColorTexture is None else cutoff / opacity,
        )


def _extension(document: dict[str, Any], name: str) -> dict[str, Any]:
    extensions = document.get("extensions") or {}
    return extensions.get(f"KHR_materials_{name}") or {}


def _cutoff(document: dict[str, Any]) -> float | None:
    """Opacity below which there is a hole; None where all is solid. What is blended counts as cut out at one half."""
    mode = document.get("alphaMode", "OPAQUE")
    if mode == "OPAQUE":
        return None
    return float(document.get("alphaCutoff", CUTOFF)) if mode == "MASK" else CUTOFF


def _coat(document: dict[str, Any]) -> float:
    """The refractive index whose reflectance at normal incidence is that of `document`.

    KHR_materials_ior has an index, 0 of which is a mirror's; KHR_materials_specular a factor and a colour.
    """
    ior, specular = _extension(document, "ior").get("ior", IOR), _extension(document, "specular")
    tint = np.mean(specular.get("specularColorFactor", WHITE))
    reflectance = min(((ior - 1.0) / (ior + 1.0)) ** 2 * tint, 1.0) * specular.get("specularFactor", 1.0)
    root = math.sqrt(min(reflectance, MAX_REFLECTANCE))
    return float((1.0 + root) / (1.0 - root))


def _means(image: Image | None) -> tuple[float, float]:
    """Roughness and metalness, 0..1, averaged over their texture, whose channels two and three they are."""
    if image is None:
        return 1.0, 1.0
    _, rough, metal = image.mean((0, 1)) / 255.0
    return float(rough), float(metal)
