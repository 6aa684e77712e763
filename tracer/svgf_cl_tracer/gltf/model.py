"""All of a file together."""

from __future__ import annotations

from pathlib import Path

from svgf_cl_tracer.errors import SceneError
from svgf_cl_tracer.meshes import instance
from svgf_cl_tracer.model import Model, Object
from svgf_cl_tracer.vectors import Float64

from .file import Gltf
from .lights import read_camera, read_lights
from .materials import Materials
from .nodes import Nodes

# Each takes a few hundred bytes; a small file may show the same mesh in any number of nodes.
MAX_TRIANGLES = 2**25


def load_gltf(path: Path, to_world: Float64) -> Model:
    """Load the default scene of a .gltf or .glb file.

    Skins and morph targets are shown as their meshes are stored.

    Parameters
    ----------
    path : Path
    to_world : (4, 4) float
        From the file's frame into the world's.

    Raises
    ------
    SceneError
        It holds something that would be shown wrongly.
    Exception
        Of many kinds, where the file is damaged.
    """
    gltf = Gltf.read(path)
    nodes, materials, meshes = Nodes(gltf, to_world), Materials(gltf.document.get("materials", [])), gltf.meshes()
    objects, room = [], MAX_TRIANGLES
    for chain in nodes.chains():
        for mesh in meshes.get(nodes.node(chain).get("mesh", -1), []):
            room -= len(mesh.faces)
            if room < 0:
                raise SceneError(f"meshes: expected at most {MAX_TRIANGLES} triangles in all nodes, found more")
            name, material = materials.of(mesh)
            if material is not None:
                objects.append(Object(instance(mesh, nodes.motion(chain), material), nodes.names(chain), name))
    return Model(objects, list(read_lights(gltf, nodes)), read_camera(gltf, nodes))
