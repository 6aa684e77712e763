"""The triangles of a file's meshes, one `Mesh` for each primitive.

trimesh is not used for this, because it does not scale integer texture coordinates. Without a warning, it leaves out
strips, fans and (if there is a material) vertex colours.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from svgf_cl_tracer.errors import SceneError
from svgf_cl_tracer.meshes import Mesh
from svgf_cl_tracer.vectors import Float64

from .extensions import DRACO
from .file import Gltf, entry
from .textures import Coordinates

POINTS, LINES, LINE_LOOP, LINE_STRIP, TRIANGLES, TRIANGLE_STRIP, TRIANGLE_FAN = range(7)
MODES = ("points", "lines", "line loops", "line strips", "triangles", "triangle strips", "triangle fans")


@dataclass(frozen=True, eq=False)
class Primitive:
    """A part of a mesh, and the number of its material; None if it has no material."""

    mesh: Mesh
    material: int | None


def mode_of(document: dict[str, Any]) -> int:
    """How the corners of a primitive form triangles; `SceneError` if it is none of `MODES`."""
    mode = document.get("mode", TRIANGLES)
    entry(MODES, "mode", mode)
    return int(mode)


def is_shown(document: dict[str, Any]) -> bool:
    """Whether a primitive consists of triangles."""
    return mode_of(document) >= TRIANGLES and "POSITION" in document["attributes"]


def read_primitive(gltf: Gltf, document: dict[str, Any], coordinates: Coordinates) -> Primitive:
    """Read a primitive that is shown, with the texture `coordinates` that its textures need.

    Raises
    ------
    SceneError
        If the file does not contain its numbers, or the numbers do not match.
    """
    attributes = document["attributes"]
    if DRACO in document.get("extensions", {}) and "bufferView" not in gltf.item("accessors", attributes["POSITION"]):
        raise SceneError(f"meshes: expected plain numbers, found those of {DRACO} alone; export it without compression")
    vertices = _attribute(gltf, attributes["POSITION"], ("VEC3",))
    optional = {"NORMAL": ("VEC3",), coordinates.attribute: ("VEC2",), "COLOR_0": ("VEC3", "VEC4")}
    found = {name: _attribute(gltf, attributes[name], kinds) for name, kinds in optional.items() if name in attributes}
    for name, values in found.items():
        if len(values) != len(vertices):
            raise SceneError(f"{name}: expected as many as of POSITION, {len(vertices)}, found {len(values)}")
    uv, colours = found.get(coordinates.attribute), found.get("COLOR_0")
    mesh = Mesh(
        vertices,
        triangles(_indices(gltf, document, len(vertices)), mode_of(document)),
        found.get("NORMAL"),
        None if uv is None else coordinates.applied(uv),
        None if colours is None else np.clip(colours[:, :3], 0.0, 1.0),
    )
    return Primitive(mesh, document.get("material"))


def triangles(corners: NDArray[np.int64], mode: int) -> NDArray[np.int64]:
    """The triangles (F, 3) that `corners` (N,) form; an incomplete last triangle is left out.

    Source of the order of corners: glTF 2.0, 3.7.2.1.
    """
    if mode == TRIANGLES:
        return corners[: len(corners) // 3 * 3].reshape(-1, 3)
    first = np.arange(max(len(corners) - 2, 0))
    if mode == TRIANGLE_FAN:
        return np.stack([corners[first + 1], corners[first + 2], np.broadcast_to(corners[:1], len(first))], axis=1)
    odd = first % 2  # every other triangle has the opposite orientation
    return np.stack([corners[first], corners[first + 1 + odd], corners[first + 2 - odd]], axis=1)


def _attribute(gltf: Gltf, accessor: int, kinds: tuple[str, ...]) -> Float64:
    """The numbers (V, components) of an accessor, whose type must be one of `kinds`."""
    _check_type(gltf, accessor, kinds)
    return gltf.numbers(accessor)


def _check_type(gltf: Gltf, accessor: int, kinds: tuple[str, ...]) -> None:
    found = gltf.item("accessors", accessor).get("type")
    if found not in kinds:
        raise SceneError(f"accessors[{accessor}]: expected the type {' or '.join(kinds)}, found {found}")


def _indices(gltf: Gltf, document: dict[str, Any], count: int) -> NDArray[np.int64]:
    """The corners (N,) of a primitive, as indices of its `count` vertices."""
    if "indices" not in document:
        return np.arange(count)
    accessor = document["indices"]
    _check_type(gltf, accessor, ("SCALAR",))
    indices = gltf.values(accessor)[:, 0]
    if indices.dtype.kind != "u" or (indices >= count).any():
        raise SceneError(f"accessors[{accessor}]: expected whole numbers from 0 and below {count}, found others")
    return indices.astype(np.int64)
