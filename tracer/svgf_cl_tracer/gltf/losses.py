"""What of a file is not shown, or not as the file has it: a line a kind, told from its JSON."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator
from typing import Any

from .extensions import INVISIBLE, READ, WITH_FALLBACK
from .file import Gltf
from .materials import base_texture
from .nodes import REST, Nodes
from .primitives import MODES, TRIANGLES, is_shown, mode_of
from .textures import Coordinates

# Parts of a material that are not read at all.
UNREAD_TEXTURES = ("normalTexture", "occlusionTexture")
UNREAD_EXTENSION_TEXTURES = ("transmissionTexture", "specularTexture", "specularColorTexture")

REPEAT, NEAREST = 10497, 9728


def losses(gltf: Gltf, nodes: Nodes) -> Iterator[str]:
    """What a user should know who expects to see the file as it is, in a few words each.

    Parameters
    ----------
    gltf : Gltf
    nodes : Nodes
        Those that are shown.
    """
    chains = list(nodes.chains())
    shown = [nodes.node(chain) for chain in chains]
    primitives = [p for index in _used(shown, "mesh") for p in gltf.item("meshes", index)["primitives"]]
    materials = [gltf.item("materials", index) for index in _used(primitives, "material")]
    yield from _of_extensions(gltf)
    yield from _of_scenes(gltf, {index for chain in chains for index in chain})
    yield from _of_primitives(gltf, primitives)
    yield from _of_materials(gltf, materials)
    yield from _of_cameras(gltf, shown)
    yield from _of_animations(gltf, shown)


def _used(documents: Iterable[dict[str, Any]], key: str) -> list[int]:
    """The places that `documents` name by `key`, each once."""
    return list(dict.fromkeys(document[key] for document in documents if key in document))


def _of_extensions(gltf: Gltf) -> Iterator[str]:
    named = {*gltf.document.get("extensionsUsed", []), *_extensions(gltf.document)}
    unknown = sorted(named - READ - INVISIBLE - WITH_FALLBACK)
    if unknown:
        yield f"extensions that are not read: {', '.join(unknown)}"


def _extensions(document: dict[str, Any]) -> Iterator[str]:
    """The names of all extensions somewhere in the file."""
    waiting: list[Any] = [document]
    while waiting:
        value = waiting.pop()
        if isinstance(value, dict):
            if isinstance(value.get("extensions"), dict):
                yield from value["extensions"]
            waiting += (value[key] for key in value if key != "extras")
        elif isinstance(value, list):
            waiting += value


def _of_scenes(gltf: Gltf, shown: set[int]) -> Iterator[str]:
    scenes = len(gltf.document.get("scenes", []))
    if scenes > 1:
        yield f"scenes[{gltf.document.get('scene', 0)}] of {scenes} is shown"
    left = [
        n
        for n, node in enumerate(gltf.document.get("nodes", []))
        if n not in shown and {"mesh", "camera"} & node.keys()
    ]
    if left:
        yield f"nodes that are not in the scene shown: {len(left)} with a mesh or camera"


def _of_primitives(gltf: Gltf, primitives: list[dict[str, Any]]) -> Iterator[str]:
    kinds = Counter(
        MODES[mode_of(p)] if "POSITION" in p["attributes"] else "no POSITION" for p in primitives if not is_shown(p)
    )
    if kinds:
        yield f"primitives that are not shown: {_counted(kinds)}"
    shown = [p for p in primitives if is_shown(p)]
    rests = Counter(MODES[mode_of(p)] for p in shown if _rest(gltf, p))
    if rests:
        yield f"primitives that end in corners which make no whole triangle: {_counted(rests)}"
    morphed = sum("targets" in p for p in shown)
    if morphed:
        yield f"morph targets are not read: {morphed} primitives are shown as they are stored"
    bare = Counter(c.attribute for p in shown if (c := _wanted(gltf, p)) and c.attribute not in p["attributes"])
    if bare:
        yield f"primitives without the coordinates of their texture, which show one texel of it: {_counted(bare)}"
    cut = sum(_has_opacity(gltf, p) for p in shown)
    if cut:
        yield f"the opacity of vertex colours is not read: {cut} primitives"


def _rest(gltf: Gltf, primitive: dict[str, Any]) -> bool:
    """Whether there are corners left over."""
    corners = gltf.item("accessors", primitive.get("indices", primitive["attributes"]["POSITION"]))["count"]
    return bool(corners % 3 if mode_of(primitive) == TRIANGLES else corners < 3)


def _wanted(gltf: Gltf, primitive: dict[str, Any]) -> Coordinates | None:
    """The texture coordinates that a primitive's material asks for, if any."""
    material = gltf.item("materials", primitive["material"]) if "material" in primitive else {}
    texture = base_texture(material) or material.get("emissiveTexture")
    return Coordinates.of(texture) if texture else None


def _has_opacity(gltf: Gltf, primitive: dict[str, Any]) -> bool:
    """Whether a primitive's corners have an opacity, on a material for which that matters."""
    if "material" not in primitive or "COLOR_0" not in primitive["attributes"]:
        return False
    mode = gltf.item("materials", primitive["material"]).get("alphaMode", "OPAQUE")
    return bool(mode != "OPAQUE" and gltf.item("accessors", primitive["attributes"]["COLOR_0"])["type"] == "VEC4")


def _of_materials(gltf: Gltf, materials: list[dict[str, Any]]) -> Iterator[str]:
    unread = Counter(name for material in materials for name in _unread(material))
    if unread:
        yield f"parts of materials that are not read: {_counted(unread)}"
    changed = Counter(what for material in materials for what in _changed(gltf, material))
    if changed:
        yield f"parts of materials that are shown otherwise: {_counted(changed)}"


def _unread(material: dict[str, Any]) -> Iterator[str]:
    yield from (name for name in UNREAD_TEXTURES if name in material)
    extensions = (each for name, each in material.get("extensions", {}).items() if name in READ)
    yield from (name for each in extensions for name in UNREAD_EXTENSION_TEXTURES if name in (each or {}))


def _changed(gltf: Gltf, material: dict[str, Any]) -> Iterator[str]:
    base, emissive = base_texture(material), material.get("emissiveTexture")
    rough = material.get("pbrMetallicRoughness", {}).get("metallicRoughnessTexture")
    if rough:
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
    """How a texture is looked up, where the file says so."""
    document = gltf.item("textures", texture["index"])
    if "sampler" in document:
        yield gltf.item("samplers", document["sampler"])


def _of_cameras(gltf: Gltf, nodes: list[dict[str, Any]]) -> Iterator[str]:
    cameras = [gltf.item("cameras", node["camera"]) for node in nodes if "camera" in node]
    perspective = sum("perspective" in camera for camera in cameras)
    if perspective < len(cameras):
        yield f"cameras that are not perspective are not read: {len(cameras) - perspective}; the view is not theirs"
    if perspective > 1:
        yield f"cameras: the first perspective one of {perspective} is used"


def _of_animations(gltf: Gltf, shown: list[dict[str, Any]]) -> Iterator[str]:
    animations = gltf.document.get("animations", [])
    if len(animations) > 1:
        yield f"animations: the first of {len(animations)} is played"
    paths = Counter(channel["target"]["path"] for animation in animations[:1] for channel in animation["channels"])
    unread = Counter({path: count for path, count in paths.items() if path not in REST})
    if unread:
        yield f"channels of the animation that are not read: {_counted(unread)}"
    skinned = sum("skin" in node for node in shown)
    if skinned:
        yield f"skins are not read: {skinned} meshes are shown as they are stored"


def _counted(counts: Counter[str]) -> str:
    return ", ".join(f"{count} of {name}" for name, count in sorted(counts.items()))
