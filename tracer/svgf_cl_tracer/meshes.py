"""From what trimesh reads to what the tracer takes: triangles, colours, images."""

from __future__ import annotations

from typing import Any

import numpy as np
import PIL.Image
import trimesh

from .errors import SceneError
from .geometry import Instance
from .materials import Colour, Material
from .motion import Keyframes, Motion
from .textures import Image
from .vectors import Float64

# Of all textures of a file, 1 GB in memory: a few kilobytes may stand for as much.
MAX_PIXELS = 2**28


def instance(mesh: trimesh.Trimesh, motion: Motion, material: Material) -> Instance:
    """`mesh` on its way through the world; at its place there where it does not move."""
    transform = motion.matrix(0.0)
    # A mirrored object turns its triangles over, and with them the side that emits light.
    faces = mesh.faces if np.linalg.det(transform[:3, :3]) > 0.0 else mesh.faces[:, ::-1]
    # trimesh makes up smooth normals for every mesh that is asked for them: only those of the file are in its cache.
    normals = mesh.vertex_normals if "vertex_normals" in mesh._cache else None
    uv = getattr(mesh.visual, "uv", None)
    texcoords = None if uv is None else np.asarray(uv)[faces]
    if is_moving(motion):
        return Instance(mesh.vertices[faces], material, None if normals is None else normals[faces], texcoords, motion)
    corners = trimesh.transform_points(mesh.vertices, transform)[faces]
    if normals is not None:
        normals = trimesh.unitize(normals @ _cofactors(transform[:3, :3]).T)[faces]
    return Instance(corners, material, normals, texcoords)


def is_moving(motion: Motion) -> bool:
    """Whether anything in `motion` changes over time."""
    return any(isinstance(link, Keyframes) for link in motion.links)


def _cofactors(matrix: Float64) -> Float64:
    """What turns normals, up to length and sign, where `matrix` moves points: a flattening one has no inverse."""
    a, b, c = matrix / (np.abs(matrix).max() or 1.0)  # else the products of a small scale are taken for zero
    return np.array([np.cross(b, c), np.cross(c, a), np.cross(a, b)])


def unnamed_material(mesh: trimesh.Trimesh) -> Material:
    """The material of a mesh whose file names none: grey, or the mesh's main vertex colour."""
    visual: Any = mesh.visual
    return Material(colour(visual.main_color / 255.0)) if visual.defined else Material()


def colour(values: Any) -> Colour:
    """Three numbers from three or more, or from one that stands for all."""
    r, g, b = np.broadcast_to(np.ravel(values).astype(float)[:3], 3)
    return float(r), float(g), float(b)


class Images:
    """Pixels of a file's images, each unpacked once however many materials show it."""

    def __init__(self) -> None:
        self._unpacked: dict[tuple[int, str], tuple[PIL.Image.Image, Image]] = {}
        self._room = MAX_PIXELS

    def pixels(self, image: PIL.Image.Image | None, mode: str) -> Image | None:
        """The image as (h, w, channels) with the channels of `mode`, such as ``"RGB"``; None for none.

        Raises
        ------
        SceneError
            The file's images are too large together.
        """
        if image is None:
            return None
        key = (id(image), mode)
        if key not in self._unpacked:
            self._room -= image.width * image.height
            if self._room < 0:
                raise SceneError(f"images: expected at most {MAX_PIXELS} pixels in all, found more")
            self._unpacked[key] = (image, np.asarray(image.convert(mode)))  # the image stays, and with it its id
        return self._unpacked[key][1]
