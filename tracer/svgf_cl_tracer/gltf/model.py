"""Loads a glTF file."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from svgf_cl_tracer.errors import SceneError
from svgf_cl_tracer.meshes import instance
from svgf_cl_tracer.model import Model, Object
from svgf_cl_tracer.motion import Motion
from svgf_cl_tracer.vectors import Float64

from .file import Gltf
from .instancing import places
from .lights import read_camera, read_lights
from .losses import losses_of
from .materials import Materials
from .nodes import Nodes
from .primitives import Primitive, is_shown, read_primitive

# The most objects. Each takes a few hundred bytes, and even a small file may show a mesh in any number of nodes.
MAX_TRIANGLES = 2**25


def load_gltf(path: Path, to_world: Float64) -> Model:
    """Load the default scene of a .gltf or .glb file; warnings say what is shown differently from the file.

    Parameters
    ----------
    path : Path
    to_world : (4, 4) float
        From the file's frame into the world.

    Raises
    ------
    SceneError
        If it contains something that would be shown wrongly.
    Exception
        If the file is damaged; errors of many kinds are possible.
    """
    gltf = Gltf.read(path)
    nodes = Nodes(gltf, to_world)
    model = Model(list(_objects(gltf, nodes)), list(read_lights(gltf, nodes)), read_camera(gltf, nodes))
    losses_of(gltf, nodes).warn(path)
    return model


def _objects(gltf: Gltf, nodes: Nodes) -> Iterator[Object]:
    """An object for each primitive of each node, for each place where the node shows it."""
    materials, meshes, room = Materials(gltf), dict[int, list[Primitive]](), MAX_TRIANGLES
    for chain in nodes.chains():
        node = nodes.node(chain)
        if "mesh" not in node:
            continue
        if node["mesh"] not in meshes:
            meshes[node["mesh"]] = _primitives(gltf, node["mesh"], materials)
        for place in places(gltf, node):
            for primitive in meshes[node["mesh"]]:
                room -= len(primitive.mesh.faces)
                if room < 0:
                    raise SceneError(f"meshes: expected at most {MAX_TRIANGLES} triangles in all nodes, found more")
                name, material = materials.of(primitive.material, coloured=primitive.mesh.colours is not None)
                if material is not None:
                    motion = Motion([*nodes.motion(chain).links, place])
                    yield Object(instance(primitive.mesh, motion, material), nodes.names(chain), name)


def _primitives(gltf: Gltf, mesh: int, materials: Materials) -> list[Primitive]:
    shown = filter(is_shown, gltf.item("meshes", mesh)["primitives"])
    return [read_primitive(gltf, part, materials.coordinates(part.get("material"))) for part in shown]
