"""The triangles of an OBJ file, and the values at their corners."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from svgf_cl_tracer.geometry import unit
from svgf_cl_tracer.losses import Losses
from svgf_cl_tracer.meshes import Mesh
from svgf_cl_tracer.textures import srgb_to_linear
from svgf_cl_tracer.vectors import Float64

from .faces import ABSENT, Faces
from .polygons import triangulate
from .text import NONE, Indices, Lines

FLAT: tuple[list[str], ...] = ([], ["0"], ["off"])  # the words after `s` that mean that there is no smoothing group


@dataclass(frozen=True, eq=False)
class Surface:
    """All triangles of a file.

    Parameters
    ----------
    positions : (V, 3) float
    uv : (VT, 2) float
    normals : (VN, 3) float
        Unit vectors.
    colours : (V, 3) float or None
        Linear, 0..1.
    corners : (T, 3, 3) int
        Triangle, corner, indices of position, texture coordinates and normal; `ABSENT` if there is none.
    lines : (T,) int
        The line of the file with the face of each triangle, ascending.
    """

    positions: Float64
    uv: Float64
    normals: Float64
    colours: Float64 | None
    corners: Indices
    lines: Indices

    @classmethod
    def read(cls, lines: Mapping[str, Lines], losses: Losses) -> Surface:
        """Read the faces of a file from its lines by keyword.

        Raises
        ------
        SceneError
            If a line is invalid.
        """
        vertices = lines.get("v", NONE).table(3, 6)
        normals, named = _directions(lines.get("vn", NONE).table(3, 3, finite=False))
        elements = (lines.get("v", NONE), lines.get("vt", NONE), lines.get("vn", NONE))
        faces = Faces.read(lines.get("f", NONE), elements)
        if (faces.counts < 3).any():
            losses.add("lines that are not read", "f with fewer than 3 corners", int((faces.counts < 3).sum()))
            faces = faces.with_area()
        triangles, owners = triangulate(vertices[faces.corners[:, 0], :3], faces.counts)
        corners = faces.corners[triangles]
        corners[..., 2] = named[corners[..., 2]]
        uv = np.nan_to_num(lines.get("vt", NONE).table(1, 2))
        flat = cls(vertices[:, :3], uv, normals, _colours(vertices[:, 3:]), corners, faces.lines[owners])
        return flat.smoothed(lines.get("s", NONE))

    def smoothed(self, groups: Lines) -> Surface:
        """The surface, with missing normals computed in smoothing groups as the mean of the faces around."""
        names, group = groups.named(self.lines)
        smooth = np.array([name.split()[:1] not in FLAT for name in names])
        chosen = np.flatnonzero(smooth[group] & (self.corners[..., 2] == ABSENT).any(1))
        vertex = self.corners[chosen, :, 0]
        keys, number = np.unique(vertex * len(names) + group[chosen, None], return_inverse=True)
        sums = np.zeros((len(keys), 3))
        np.add.at(sums, number.reshape(vertex.shape), _weighted_normals(self.positions[vertex]))
        corners = self.corners.copy()
        corners[chosen, :, 2] = len(self.normals) + number.reshape(vertex.shape)
        normals = np.concatenate([self.normals, unit(sums)])
        return Surface(self.positions, self.uv, normals, self.colours, corners, self.lines)

    def mesh(self, chosen: Indices) -> Mesh:
        """The chosen triangles as a mesh without shared corners; missing texture coordinates are NaN."""
        position, texture, normal = self.corners[chosen].reshape(-1, 3).T
        vertices, normals = self.positions[position], _values(self.normals, normal)
        if normals is not None:  # a triangle without normals, among others that have them, is flat
            flat = unit(_areas(vertices.reshape(-1, 3, 3))).repeat(3, axis=0)
            normals = np.where(np.isnan(normals), flat, normals)
        colours = None if self.colours is None else self.colours[position]
        faces = np.arange(len(vertices)).reshape(-1, 3)
        return Mesh(vertices, faces, normals, _values(self.uv, texture), colours)


def _directions(vectors: Float64) -> tuple[Float64, Indices]:
    """Unit vectors, and the index of each by the number of its line; `ABSENT` if the line has no direction.

    Many programs write zeros or NaN as normals of faces without area.
    """
    with np.errstate(invalid="ignore", over="ignore"):
        length = np.linalg.norm(vectors, axis=1)
        good = np.isfinite(length) & (length > 0.0)
    index = np.where(good, np.arange(len(vectors)), ABSENT)
    directions: Float64 = unit(np.where(good[:, None], vectors, 0.0)).astype(np.float64)
    return directions, np.append(index, ABSENT)


def _colours(values: Float64) -> Float64 | None:
    """Linear colours, from sRGB values after positions, as Blender and MeshLab write them; white where missing."""
    given = np.asarray(np.isfinite(values).all(1))
    if not given.any():
        return None
    colours = np.where(given[:, None], values, 1.0)
    if colours.max() > 1.0:  # some programs write 0..255
        colours[given] /= 255.0
    return srgb_to_linear(np.clip(colours, 0.0, 1.0))


def _values(values: Float64, index: Indices) -> Float64 | None:
    """The rows of `values` at each index, NaN for absent ones; None if all are absent."""
    absent = index == ABSENT
    if absent.all():
        return None
    found = values[index]
    found[absent] = np.nan
    return found


def _areas(corners: Float64) -> Float64:
    """Normals (n, 3) of triangles; their lengths are twice the areas."""
    return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])


def _weighted_normals(corners: Float64) -> Float64:
    """Normals (n, 3, 3) at corners of triangles.

    Their lengths are the angles, so the division of a face does not matter.
    """
    after, before = np.roll(corners, -1, axis=1) - corners, np.roll(corners, 1, axis=1) - corners
    normals = np.cross(after, before)
    angles = np.arctan2(np.linalg.norm(normals, axis=2), (after * before).sum(2))
    weighted: Float64 = unit(normals) * angles[..., None]
    return weighted
