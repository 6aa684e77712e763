"""What the faces of an OBJ file are made of: triangles, and the values at their corners."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from svgf_cl_tracer.textures import srgb_to_linear
from svgf_cl_tracer.vectors import Float64

from .faces import ABSENT, Faces
from .losses import Losses
from .polygons import triangulate
from .text import NONE, Indices, Lines

FLAT: tuple[list[str], ...] = ([], ["0"], ["off"])  # what `s` says where there is no smoothing group


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
        Triangle, corner, indices of its position, texture coordinates and normal; `ABSENT` where it has none.
    lines : (T,) int
        On which line of the file the face of each is, ascending.
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
            A line makes no sense.
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
        """The surface with normals in smoothing groups, the mean of the faces around, where the file has none."""
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

    def positions_of(self, chosen: Indices) -> Float64:
        """The corners (n, 3, 3) of the triangles chosen."""
        return self.positions[self.corners[chosen, :, 0]]

    def uv_of(self, chosen: Indices) -> Float64 | None:
        """Texture coordinates (n, 3, 2) of the triangles chosen, NaN at corners without any; None where all are."""
        return _values(self.uv, self.corners[chosen, :, 1])

    def normals_of(self, chosen: Indices) -> Float64 | None:
        """Normals (n, 3, 3) of the triangles chosen, their own where a corner has none; None where all have none."""
        normals = _values(self.normals, self.corners[chosen, :, 2])
        if normals is None:
            return None
        faces = unit(_areas(self.positions_of(chosen)))[:, None]
        return np.where(np.isnan(normals), faces, normals)

    def colours_of(self, chosen: Indices) -> Float64 | None:
        """Colours (n, 3, 3) of the triangles chosen; None where the file has none."""
        return None if self.colours is None else self.colours[self.corners[chosen, :, 0]]


def _directions(vectors: Float64) -> tuple[Float64, Indices]:
    """Unit vectors, and the index of each by the number of its line; `ABSENT` where the line holds no direction.

    Many programs write zeros or NaN for the normals of what has no area.
    """
    with np.errstate(invalid="ignore", over="ignore"):
        length = np.linalg.norm(vectors, axis=1)
        good = np.isfinite(length) & (length > 0.0)
    index = np.where(good, np.arange(len(vectors)), ABSENT)
    return unit(np.where(good[:, None], vectors, 0.0)), np.append(index, ABSENT)


def _colours(values: Float64) -> Float64 | None:
    """Linear colours for those behind positions, sRGB as in Blender and MeshLab; white where there are none."""
    given = np.asarray(np.isfinite(values).all(1))
    if not given.any():
        return None
    colours = np.where(given[:, None], values, 1.0)
    if colours.max() > 1.0:  # some programs count to 255
        colours[given] /= 255.0
    return srgb_to_linear(np.clip(colours, 0.0, 1.0))


def _values(values: Float64, index: Indices) -> Float64 | None:
    absent = index == ABSENT
    if absent.all():
        return None
    found = values[index]
    found[absent] = np.nan
    return found


def _areas(corners: Float64) -> Float64:
    """Normals (n, 3) of triangles, twice as long as their areas."""
    return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])


def _weighted_normals(corners: Float64) -> Float64:
    """Normals (n, 3, 3) at corners of triangles, as long as their angles: however a face is cut, it counts alike."""
    after, before = np.roll(corners, -1, axis=1) - corners, np.roll(corners, 1, axis=1) - corners
    normals = np.cross(after, before)
    angles = np.arctan2(np.linalg.norm(normals, axis=2), (after * before).sum(2))
    weighted: Float64 = unit(normals) * angles[..., None]
    return weighted


def unit(vectors: NDArray[np.float64]) -> Float64:
    """`vectors` (..., 3) at length 1; those of length 0 as they are."""
    lengths = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return vectors / np.where(lengths > 0.0, lengths, 1.0)
