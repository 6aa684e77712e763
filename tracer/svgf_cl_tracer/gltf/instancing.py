"""EXT_mesh_gpu_instancing: shows a node's mesh many times, at several places in the node's frame."""

from __future__ import annotations

from typing import Any

import numpy as np

from svgf_cl_tracer.errors import SceneError
from svgf_cl_tracer.motion import Keyframes, Track
from svgf_cl_tracer.vectors import Float64

from .extensions import INSTANCING
from .file import COLUMNS, Gltf

TYPES = {"TRANSLATION": "VEC3", "ROTATION": "VEC4", "SCALE": "VEC3"}

# The most instances of one node, each of which becomes an object.
MAX_INSTANCES = 2**18


def places(gltf: Gltf, node: dict[str, Any]) -> list[Float64]:
    """The places of a node's mesh in the node's frame: transforms (4, 4); one identity if the file lists none.

    Raises
    ------
    SceneError
        If the file does not contain their numbers, or the numbers do not match.
    """
    extension = node.get("extensions", {}).get(INSTANCING)
    if extension is None:
        return [np.eye(4)]
    attributes = extension.get("attributes", {})
    values = {name: _values(gltf, attributes[name], kind) for name, kind in TYPES.items() if name in attributes}
    counts = sorted({len(each) for each in values.values()})
    if len(counts) != 1 or counts[0] > MAX_INSTANCES:
        raise SceneError(f"{INSTANCING}: expected as many of each, 1..{MAX_INSTANCES}, found {counts}")
    return [_matrix({name.lower(): each[row] for name, each in values.items()}) for row in range(counts[0])]


def _matrix(values: dict[str, Float64]) -> Float64:
    return Keyframes(**{name: Track([0.0], [value]) for name, value in values.items()}).matrix(0.0)


def _values(gltf: Gltf, accessor: int, kind: str) -> Float64:
    found = gltf.numbers(accessor)
    if found.shape[1] != COLUMNS[kind]:
        raise SceneError(f"accessors[{accessor}]: expected the type {kind}, found {found.shape[1]} numbers each")
    return found
