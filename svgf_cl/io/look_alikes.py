"""Finds channels that look like a missing field, because renderers have many names for each field."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable

from svgf_cl.io.layers import PICTURES

# Renderers' names of the layer of each field, in small letters without spaces and signs; the most likely first.
LAYERS: dict[str, tuple[str, ...]] = {
    "color": (*PICTURES, "r", "g", "b"),
    "albedo": (
        *("albedo", "denoisingalbedo", "diffusealbedo", "basecolor", "diffusecolor", "diffcol", "diffusefilter"),
        *("vraydiffusefilter", "rawdiffusefilter", "reflectance", "kd", "oidnalbedo"),
    ),
    "normal": (
        *("normal", "normals", "n", "ns", "nn", "shnormal", "shadingnormal", "worldnormal", "normalworld", "nworld"),
        *("vraynormals", "normalvector", "bumpnormals", "denoisingnormal", "oidnnormal", "ng", "geonormal"),
    ),
    "depth": (
        *("depth", "z", "zdepth", "viewz", "cameradepth", "depthz", "vrayzdepth", "linearz", "lineardepth"),
        *("distance", "dd", "zbuffer", "denoisingdepth", "deptheye"),
    ),
    "motion": (
        *("motion", "motionvector", "motionvectors", "motionvec", "vector", "vectors", "velocity", "vrayvelocity"),
        *("mv", "mvec", "speed", "opticalflow", "flow", "forwardflow", "backwardflow", "motion2d", "screenmotion"),
    ),
    "id": (
        *("id", "ids", "objectid", "objid", "indexob", "objectindex", "idx", "instanceid", "nodeid", "renderid"),
        *("vrayobjectid", "vraynodeid", "vrayrenderid", "shapeindex", "geometryid"),
    ),
    "emission": ("emission", "emit", "emissive", "emissioncolor", "selfillumination", "selfillum"),
    "direct": ("direct", "directlight", "directlighting", "directillumination"),
    "indirect": ("indirect", "indirectlight", "indirectlighting", "indirectillumination", "gi", "globalillumination"),
}
# Names of components after the layer's name. A layer that has only alpha does not count.
COMPONENTS = ("r", "g", "b", "a", "x", "y", "z", "w", "u", "v", "t", "i", "red", "green", "blue", "alpha")
ALPHA = ({"a"}, {"alpha"})
NO_DEPTH = ("mist",)  # layers that are no depth, though they have only the component Z
SHOWN = 2  # layers that are shown for a field


def look_alikes(channels: Iterable[str], fields: Collection[str]) -> dict[str, list[str]]:
    """Find channels that may be meant for a field.

    Parameters
    ----------
    channels : iterable of str
        The channels of a file that are not read.
    fields : collection of str
        The fields that are missing.

    Returns
    -------
    dict of str to list of str
        The channels for each of `fields` that has any, as texts of `grouped`; the most likely first.
    """
    layers: dict[str, list[str]] = {}
    for channel in channels:
        layers.setdefault(split(channel)[0], []).append(channel)
    found: dict[str, list[tuple[int, str]]] = {}
    for layer, names in layers.items():
        components = {split(name)[1].casefold() for name in names}
        word = re.sub(r"[\W_]", "", layer.rpartition(".")[2].casefold())
        for field in fields:
            known = LAYERS.get(field, (field,))
            if components == {"z"} and word not in NO_DEPTH:  # a position would have x and y as well
                known = (*known, word) if field == "depth" else ()
            if word in known and components not in ALPHA:
                found.setdefault(field, []).append((known.index(word), grouped(names)))
    return {field: [text for _, text in sorted(found[field])][:SHOWN] for field in fields if field in found}


def split(channel: str) -> tuple[str, str]:
    """Split a channel's name into its layer's name and its component's name, which may be empty."""
    layer, dot, component = channel.rpartition(".")
    return (layer, component) if dot and component.casefold() in COMPONENTS else (channel, "")


def grouped(channels: Iterable[str]) -> str:
    """Return channels as a text that has each layer's name once: ``normal.X Y Z``."""
    words, last = [], None
    for channel in channels:
        layer, component = split(channel)
        words.append(component if component and layer == last else channel)
        last = layer
    return " ".join(words)


def advice(channels: Iterable[str], wanted: dict[str, tuple[str, ...]]) -> str:
    """Return which channels look like missing fields, and the options to read them; empty if none does.

    Parameters
    ----------
    channels : iterable of str
        All channels of a file.
    wanted : dict of str to tuple of str
        The channels of each field that is missing.
    """
    right = {name for names in wanted.values() for name in names}
    found = look_alikes((name for name in channels if name not in right), wanted)
    parts = []
    for field, texts in found.items():
        look = "looks" if len(texts) == 1 else "look"
        options = " or ".join(f"--map {field}={spelled(text)}" for text in texts)
        parts.append(f"{', '.join(texts)} {look} like {field}: if it is, give {options}")
    return "; ".join(parts)


def spelled(text: str) -> str:
    """Return the layer's name in a text of `grouped`, quoted for a shell if necessary."""
    first = text if text.count(" ") == text.rpartition(".")[0].count(" ") else text[: text.rindex(".") + 2]
    layer = split(first)[0]
    return f"'{layer}'" if " " in layer else layer
