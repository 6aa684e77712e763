"""OBJ files with their MTL materials, through trimesh."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import trimesh

from .materials import Material
from .meshes import Images, Mesh, colour, instance
from .model import Model, Object
from .motion import Motion
from .vectors import Float64


def load_obj(path: Path, to_world: Float64) -> Model:
    """Load an .obj file; `to_world` (4, 4) leads from its frame into the world's.

    Of a material colour (Kd), texture (map_Kd) and emission (Ke) are read: a Lambertian surface.
    """
    loaded = trimesh.load_scene(path)
    images, made, objects = Images(), dict[str, Material](), []
    for node in loaded.graph.nodes_geometry:
        transform, geometry = loaded.graph[node]
        mesh = loaded.geometry[geometry]
        if isinstance(mesh, trimesh.Trimesh):
            source = getattr(mesh.visual, "material", None)
            name = getattr(source, "name", None) or ""
            if name not in made or not name:
                made[name] = _material(source, images) if name else _unnamed_material(mesh)
            objects.append(Object(instance(_mesh(mesh), Motion([to_world, transform]), made[name]), (node,), name))
    return Model(objects)


def _material(source: Any, images: Images) -> Material:
    known = source.kwargs
    base = known.get("kd", (1.0, 1.0, 1.0) if source.image is not None else Material.base_colour)
    return Material(colour(base), colour(known.get("ke", (0.0, 0.0, 0.0))), images.pixels(source.image, "RGB"))


def _mesh(mesh: trimesh.Trimesh) -> Mesh:
    # trimesh makes up smooth normals for every mesh that is asked for them: only those of the file are in its cache.
    normals = mesh.vertex_normals if "vertex_normals" in mesh._cache else None
    return Mesh(mesh.vertices, mesh.faces, normals, getattr(mesh.visual, "uv", None))


def _unnamed_material(mesh: trimesh.Trimesh) -> Material:
    """The material of a mesh whose file names none: grey, or the mesh's main vertex colour."""
    visual: Any = mesh.visual
    return Material(colour(visual.main_color / 255.0)) if visual.defined else Material()
