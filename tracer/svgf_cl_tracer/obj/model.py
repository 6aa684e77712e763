"""Loads an OBJ file."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from svgf_cl.errors import shown
from svgf_cl_tracer.errors import SceneError
from svgf_cl_tracer.folder import found_inside
from svgf_cl_tracer.losses import Losses
from svgf_cl_tracer.meshes import instance
from svgf_cl_tracer.model import Model, Object
from svgf_cl_tracer.motion import Motion
from svgf_cl_tracer.vectors import Float64

from .library import Definition, read_library
from .materials import Materials
from .surface import Surface
from .text import NONE, Indices, Lines, by_keyword, read_text, uncommented

READ = {"v", "vt", "vn", "f", "o", "g", "s", "usemtl", "mtllib"}
# Lines inside curves and surfaces (whose first lines give a warning), hints for renderers, levels of detail.
INVISIBLE = {
    *("vp", "cstype", "deg", "bmat", "step", "parm", "trim", "hole", "scrv", "sp", "end", "con", "ctech", "stech"),
    *("mg", "bevel", "c_interp", "d_interp", "lod", "shadow_obj", "trace_obj"),
}


def load_obj(path: Path, to_world: Float64) -> Model:
    """Load an .obj file; warnings say what is shown differently from the file.

    Parameters
    ----------
    path : Path
    to_world : (4, 4) float
        From the file's frame into the world.

    Returns
    -------
    Model
        An object for each material of each object (`o`, or `g` in a file without `o`). Its nodes have the names of the
        file and of the object.

    Raises
    ------
    SceneError
        If a line is invalid, or an image cannot be decoded.
    """
    losses, lines = Losses(), by_keyword(read_text(path))
    for keyword in lines:
        if keyword not in READ | INVISIBLE:
            losses.add("lines that are not read", shown(keyword), len(lines[keyword].texts))
    surface = Surface.read(lines, losses)
    materials = Materials(path.parent, _definitions(path, lines.get("mtllib", NONE), losses), losses)
    objects = []
    for name, material_name, chosen in _parts(lines, surface.lines):
        mesh = surface.mesh(chosen)
        known, material = materials.of(material_name, coloured=mesh.colours is not None)
        if material is not None:
            mesh = replace(mesh, uv=materials.placed(known, mesh.uv))
            objects.append(Object(instance(mesh, Motion([to_world]), material), (path.name, name), known))
    losses.warn(path)
    return Model(objects)


def _parts(lines: Mapping[str, Lines], at: Indices) -> Iterator[tuple[str, str, Indices]]:
    """The object's name, the material's name, and the triangles that have both; triangles are on the lines `at`."""
    objects, object_of = lines.get("o", lines.get("g", NONE)).named(at)
    materials, material_of = lines.get("usemtl", NONE).named(at)
    keys = object_of * len(materials) + material_of
    parts, first, part_of = np.unique(keys, return_index=True, return_inverse=True)
    triangles = np.split(np.argsort(part_of, kind="stable"), np.cumsum(np.bincount(part_of))[:-1])
    for part in np.argsort(first):
        yield objects[parts[part] // len(materials)], materials[parts[part] % len(materials)], triangles[part]


def _definitions(path: Path, libraries: Lines, losses: Losses) -> dict[str, Definition]:
    """The materials of all libraries of a file; if several have the same name, the first one."""
    definitions: dict[str, Definition] = {}
    for text in libraries.texts:
        # A line has one name, which may contain spaces, or several names.
        names = [text] if found_inside(path.parent, text, path.parent) else uncommented(text).split()
        for name in names:
            library = found_inside(path.parent, name, path.parent)
            if library is None:
                losses.add("material libraries that are not in its folder or below", shown(name))
                continue
            try:
                definitions = read_library(library) | definitions
            except SceneError as error:
                raise SceneError(f"{library.name}: {error}") from error
    return definitions
