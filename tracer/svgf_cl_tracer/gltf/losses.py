"""Finds in a file's JSON what will be missing or different in the picture."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np

from svgf_cl.errors import shown as quoted
from svgf_cl_tracer.losses import Losses

from .extensions import INVISIBLE, LIGHTS, READ, WITH_FALLBACK
from .file import Gltf, name_of
from .materials import base_texture
from .nodes import REST, Nodes
from .primitives import MODES, TRIANGLES, is_shown, mode_of
from .textures import Coordinates

# Parts of a material that are not read.
UNREAD_TEXTURES = ("normalTexture", "occlusionTexture")
UNREAD_EXTENSION_TEXTURES = ("transmissionTexture", "specularTexture", "specularColorTexture")

FLOAT, REPEAT, NEAREST = 5126, 10497, 9728

# Number of steps of single precision across a mesh; with fewer steps, rounding of its shape becomes visible.
FINE = 1000


def losses_of(gltf: Gltf, nodes: Nodes) -> Losses:
    """What will differ from the file, as a user should know.

    Parameters
    ----------
    gltf : Gltf
    nodes : Nodes
        The nodes that are shown.
    """
    losses, chains = Losses(), list(nodes.chains())
    shown = [nodes.node(chain) for chain in chains]
    primitives = [p for index in _used(shown, "mesh") for p in gltf.item("meshes", index)["primitives"]]
    for name in sorted({*gltf.document.get("extensionsUsed", []), *_extensions(gltf.document)}):
        if name not in READ | INVISIBLE | WITH_FALLBACK:
            losses.add("extensions that are not read", name)
    _add_scenes(losses, gltf, {index for chain in chains for index in chain})
    for primitive in primitives:
        _add_primitive(losses, gltf, primitive)
    for index in _used(primitives, "material"):
        _add_material(losses, gltf, gltf.item("materials", index))
    for index in _used(shown, "camera")[1:]:
        name = _called("cameras", index, gltf.item("cameras", index))
        losses.add("cameras that are not used, as another one comes first", name)
    _add_animations(losses, gltf, shown)
    return losses


def _used(documents: Iterable[dict[str, Any]], key: str) -> list[int]:
    """The indices that `documents` give for `key`, each once."""
    return list(dict.fromkeys(document[key] for document in documents if key in document))


def _extensions(document: dict[str, Any]) -> Iterator[str]:
    """The names of all extensions anywhere in the file."""
    waiting: list[Any] = [document]
    while waiting:
        value = waiting.pop()
        if isinstance(value, dict):
            if isinstance(value.get("extensions"), dict):
                yield from value["extensions"]
            waiting += (value[key] for key in value if key != "extras")
        elif isinstance(value, list):
            waiting += value


def _called(kind: str, index: int, document: dict[str, Any]) -> str:
    """The name of an object, or its index in the file if it has no name."""
    return quoted(name) if (name := name_of(document)) else f"{kind}[{index}]"


def _add_scenes(losses: Losses, gltf: Gltf, shown: set[int]) -> None:
    for index, scene in enumerate(gltf.document.get("scenes", [])):
        if index != gltf.document.get("scene", 0):
            losses.add("scenes that are not shown", _called("scenes", index, scene))
    for index, node in enumerate(gltf.document.get("nodes", [])):
        if index not in shown and ({"mesh", "camera"} & node.keys() or LIGHTS in node.get("extensions", {})):
            losses.add("nodes that are not in the scene shown", _called("nodes", index, node))


def _add_primitive(losses: Losses, gltf: Gltf, primitive: dict[str, Any]) -> None:
    mode, attributes = mode_of(primitive), primitive["attributes"]
    if not is_shown(primitive):
        losses.add(
            "primitives that are not shown", MODES[mode] if "POSITION" in attributes else "those without POSITION"
        )
        return
    corners = gltf.item("accessors", primitive.get("indices", attributes["POSITION"]))["count"]
    if corners % 3 if mode == TRIANGLES else corners < 3:
        losses.add("primitives that end in corners which make no whole triangle", MODES[mode])
    if _is_coarse(gltf.item("accessors", attributes["POSITION"])):
        losses.add(
            "vertices far from 0, which the file has rounded: a node's translation holds more digits", MODES[mode]
        )
    if "targets" in primitive:
        losses.add("meshes that are shown as they are stored, without", "morph targets")
    if "material" in primitive:
        _add_mismatches(losses, gltf, attributes, gltf.item("materials", primitive["material"]))


def _is_coarse(positions: dict[str, Any]) -> bool:
    """Whether single precision has few steps across a mesh with these positions, because it is far from 0."""
    least, most = (np.array(positions.get(name, 0.0), np.float64) for name in ("min", "max"))
    step = np.spacing(np.float32(np.abs([least, most]).max()))
    return bool(positions["componentType"] == FLOAT and step * FINE > np.max(most - least) > 0.0)


def _add_mismatches(losses: Losses, gltf: Gltf, attributes: dict[str, int], material: dict[str, Any]) -> None:
    """Add what a material needs and the mesh lacks, and what the mesh has and the material does not use."""
    texture = base_texture(material) or material.get("emissiveTexture")
    if texture and (wanted := Coordinates.of(texture).attribute) not in attributes:
        losses.add("primitives without the coordinates of their texture, which show one texel of it", wanted)
    coloured = "COLOR_0" in attributes and gltf.item("accessors", attributes["COLOR_0"])["type"] == "VEC4"
    if coloured and material.get("alphaMode", "OPAQUE") != "OPAQUE":
        losses.add("attributes that are read without their opacity", "COLOR_0")


def _add_material(losses: Losses, gltf: Gltf, material: dict[str, Any]) -> None:
    for name in _unread(material):
        losses.add("parts of materials that are not read", name)
    for what in _changed(gltf, material):
        losses.add("parts of materials that are shown otherwise", what)


def _unread(material: dict[str, Any]) -> Iterator[str]:
    yield from (name for name in UNREAD_TEXTURES if name in material)
    extensions = (each for name, each in material.get("extensions", {}).items() if name in READ)
    yield from (name for each in extensions for name in UNREAD_EXTENSION_TEXTURES if name in (each or {}))


def _changed(gltf: Gltf, material: dict[str, Any]) -> Iterator[str]:
    base, emissive = base_texture(material), material.get("emissiveTexture")
    if "metallicRoughnessTexture" in material.get("pbrMetallicRoughness", {}):
        yield "metallicRoughnessTexture (its mean counts)"
    if base and emissive and Coordinates.of(base) != Coordinates.of(emissive):
        yield "emissiveTexture (it lies where the base colour's does)"
    if material.get("alphaMode") == "BLEND":
        yield "alphaMode BLEND (cut out below one half)"
    transmission = (material.get("extensions", {}).get("KHR_materials_transmission") or {}).get("transmissionFactor", 0)
    if 0 < transmission < 1:
        yield "transmissionFactor (glass from one half on, opaque below)"
    samplers = [sampler for texture in (base, emissive) if texture for sampler in _sampler(gltf, texture)]
    if any(sampler.get(name, REPEAT) != REPEAT for sampler in samplers for name in ("wrapS", "wrapT")):
        yield "textures that do not repeat (they do here)"
    if any(sampler.get("magFilter") == NEAREST for sampler in samplers):
        yield "magFilter NEAREST (bilinear)"


def _sampler(gltf: Gltf, texture: dict[str, Any]) -> Iterator[dict[str, Any]]:
    """How a texture is sampled, if the file defines it."""
    document = gltf.item("textures", texture["index"])
    if "sampler" in document:
        yield gltf.item("samplers", document["sampler"])


def _add_animations(losses: Losses, gltf: Gltf, shown: list[dict[str, Any]]) -> None:
    animations = gltf.document.get("animations", [])
    for index, animation in enumerate(animations[1:], 1):
        name = _called("animations", index, animation)
        losses.add("animations that are not played, as another one comes first", name)
    for path in (channel["target"]["path"] for animation in animations[:1] for channel in animation["channels"]):
        if path not in REST:
            losses.add("channels of the animation that are not read", path)
    for _ in (node for node in shown if "skin" in node):
        losses.add("meshes that are shown as they are stored, without", "skins")
