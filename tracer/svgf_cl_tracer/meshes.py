"""Converts meshes as files store them to the tracer's objects: triangles, normals, colours."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .geometry import Instance
from .materials import Colour, Material
from .motion import Motion


@dataclass(frozen=True, eq=False)
class Mesh:
    """Triangles that share vertices.

    Parameters
    ----------
    vertices : (V, 3) float
    faces : (F, 3) int
        Three vertices each, counter-clockwise as seen from the front.
    normals : (V, 3) float, optional
        Without them the triangles are flat.
    uv : (V, 2) float, optional
        Texture coordinates, v up.
    colours : (V, 3) float, optional
        Linear, 0..1: factors of the material's base colour.
    """

    vertices: NDArray[np.floating]
    faces: NDArray[np.int64]
    normals: NDArray[np.floating] | None = None
    uv: NDArray[np.floating] | None = None
    colours: NDArray[np.floating] | None = None


def instance(mesh: Mesh, motion: Motion, material: Material) -> Instance:
    """The object that `mesh` makes with this motion; if it does not move, its triangles are in the world."""
    normals, uv, colours = (v if v is None else v[mesh.faces] for v in (mesh.normals, mesh.uv, mesh.colours))
    found = Instance(mesh.vertices[mesh.faces], material, normals, uv, motion, colours)
    return found if motion.changes else found.at_rest(0.0)


def colour(values: Any) -> Colour:
    """Three numbers, from a list of three or more, or from one number for all."""
    r, g, b = np.broadcast_to(np.ravel(values).astype(float)[:3], 3)
    return float(r), float(g), float(b)
