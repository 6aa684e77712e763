"""The shapes of which the built-in scenes consist; +y is up."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
import trimesh
from numpy.typing import ArrayLike
from scipy.interpolate import PchipInterpolator
from trimesh.transformations import rotation_matrix, translation_matrix

from ..camera import Camera, Vector, vector
from ..geometry import Instance
from ..materials import Material
from ..motion import Motion
from ..vectors import Float64

UP = (0.0, 1.0, 0.0)

# (radius, height) of points on the outside of a solid of revolution, upwards.
Outline = list[tuple[float, float]]

# Triangle, corner, (right, up).
SQUARE = np.array([[[0, 0], [1, 0], [1, 1]], [[0, 0], [1, 1], [0, 1]]], float)

# Segments around a solid of revolution: enough for a smooth outline in a picture 720 pixels high.
SECTIONS = 64

# Edges with a larger angle stay sharp on a smooth surface.
EDGE = np.radians(30.0)


def quad(
    corner: ArrayLike,
    right: ArrayLike,
    up: ArrayLike,
    material: Material,
    *,
    repeat: tuple[float, float] = (1.0, 1.0),
    motion: Motion | None = None,
) -> Instance:
    """A rectangle whose front faces right x up (the cross product).

    The lower left texel of its texture is at `corner`; the texture repeats `repeat` times to the right and up.
    """
    a, b, c = np.array(corner, float), np.array(right, float), np.array(up, float)
    corners = a + SQUARE[..., :1] * b + SQUARE[..., 1:] * c
    return Instance(corners, material, uv=SQUARE * repeat, motion=motion)


def panel(centre: Vector, target: Vector, size: tuple[float, float], material: Material) -> Instance:
    """A rectangle of (width, height) `size` around `centre` whose front faces `target`.

    `target` must not be straight above or below `centre`.
    """
    right, up, _ = Camera(target, centre).basis()
    right, up = right * size[0], up * size[1]
    return quad(np.array(centre) - (right + up) / 2.0, right, up, material)


def place(
    mesh: trimesh.Trimesh,
    material: Material,
    position: Vector,
    degrees: float = 0.0,
    *,
    smooth: bool = False,
    motion: Motion | None = None,
) -> Instance:
    """A mesh that is turned about the vertical and moved to `position`."""
    mesh = mesh.copy()
    mesh.apply_transform(rotation_matrix(np.radians(degrees), UP))
    mesh.apply_transform(translation_matrix(position))
    return Instance(mesh.triangles, material, mesh.vertex_normals[mesh.faces] if smooth else None, motion=motion)


def upright(mesh: trimesh.Trimesh) -> trimesh.Trimesh:
    """A mesh made by trimesh, whose axis is z, turned so that its axis is y."""
    stood: trimesh.Trimesh = mesh.apply_transform(rotation_matrix(-np.pi / 2.0, (1, 0, 0)))
    return stood


def ball(radius: float, centre: Vector, material: Material) -> Instance:
    """A sphere."""
    return place(upright(trimesh.creation.icosphere(4, radius)), material, centre, smooth=True)


def ring(radius: float, thickness: float, centre: Vector, material: Material) -> Instance:
    """A torus that lies flat; `radius` is that of its middle line, `thickness` that of its tube."""
    return place(upright(trimesh.creation.torus(radius, thickness)), material, centre, smooth=True)


def lathe(outline: Outline, material: Material, foot: Vector, *, motion: Motion | None = None) -> Instance:
    """A solid of revolution whose foot is at `foot`."""
    mesh = upright(trimesh.creation.revolve(np.array(outline), sections=SECTIONS))
    return place(trimesh.graph.smooth_shade(mesh, angle=EDGE), material, foot, smooth=True, motion=motion)


def curve(points: Outline, steps: int = 6) -> Outline:
    """A rounded outline through `points`, with `steps` pieces between neighbours."""
    at = np.arange(len(points))
    fine = PchipInterpolator(at, points)(np.linspace(0.0, at[-1], at[-1] * steps + 1))
    return [(float(radius), float(height)) for radius, height in fine]


def box(size: Vector, centre: Vector = (0.0, 0.0, 0.0)) -> trimesh.Trimesh:
    """A block of (width, height, depth) `size`."""
    block: trimesh.Trimesh = trimesh.creation.box(size, translation_matrix(centre))
    return block


def rod(start: Vector, end: Vector, radius: float) -> trimesh.Trimesh:
    """A thin cylinder from `start` to `end`."""
    cylinder: trimesh.Trimesh = trimesh.creation.cylinder(radius, segment=(start, end), sections=10)
    return cylinder


def merged(meshes: Iterable[trimesh.Trimesh], material: Material, *, motion: Motion | None = None) -> Instance:
    """Several meshes as one object with flat shading."""
    return Instance(np.concatenate([mesh.triangles for mesh in meshes]), material, motion=motion)


def band(first: Float64, second: Float64) -> Float64:
    """Triangles (T, 3, 3) between two lines with the same number of points (n, 3) each."""
    a, b, c, d = first[:-1], first[1:], second[1:], second[:-1]
    return np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])


def orbit(centre: Vector, radius: float, height: float, degrees: Iterable[float], fov_y: float) -> list[Camera]:
    """Cameras on a circle around the vertical through `centre` that look at it.

    At 0 degrees they are on the side of +z.
    """
    angles = np.radians(list(degrees))
    eyes = np.array(centre) + np.stack([radius * np.sin(angles), 0 * angles + height, radius * np.cos(angles)], axis=1)
    return [Camera(vector(eye), centre, fov_y=fov_y) for eye in eyes]
