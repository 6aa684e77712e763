"""The built-in scenes, which need no file."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import trimesh
from trimesh.transformations import rotation_matrix, translation_matrix

from .camera import Camera, CameraPath, Vector, vector
from .errors import SceneError
from .geometry import Instance
from .materials import Material
from .scene import Scene
from .textures import Image

# Half width, height, back and front of the room, in scene units; its front is open.
HALF_WIDTH, HEIGHT, BACK, FRONT = 1.75, 2.0, -1.5, 3.2

UP = (0.0, 1.0, 0.0)


def builtin_scene(name: str = "cornell") -> Scene:
    """Make the built-in scene `name`.

    Raises
    ------
    SceneError
        There is no such scene.
    """
    if name not in BUILTIN:
        raise SceneError(f"no built-in scene {name!r}; there is: {', '.join(BUILTIN)}")
    return BUILTIN[name]()


def cornell() -> Scene:
    """An open box with coloured walls, two blocks, a ball, a ring, a lattice and a tiled floor under one lamp."""
    white = Material((0.73, 0.72, 0.69))
    w, h, b, f = HALF_WIDTH, HEIGHT, BACK, FRONT
    lamp = Material((0.0, 0.0, 0.0), emission=(17.0, 13.0, 8.5))
    instances = [
        _quad((-w, 0, f), (2 * w, 0, 0), (0, 0, b - f), Material((1.0, 1.0, 1.0), base_texture=_tiles())),
        _quad((-w, h, b), (2 * w, 0, 0), (0, 0, f - b), white),
        _quad((-w, 0, b), (2 * w, 0, 0), (0, h, 0), white),
        _quad((-w, 0, f), (0, 0, b - f), (0, h, 0), Material((0.63, 0.09, 0.06))),
        _quad((w, 0, b), (0, 0, f - b), (0, h, 0), Material((0.08, 0.30, 0.36))),
        _quad((-0.5, h - 0.01, -0.35), (1.0, 0, 0), (0, 0, 0.75), lamp),
        _quad((-0.5, 0.75, b + 0.01), (1.3, 0, 0), (0, 0.8, 0), Material((1.0, 1.0, 1.0), base_texture=_painting())),
        _place(trimesh.creation.box((0.55, 1.15, 0.55)), white, (-0.85, 0.575, -0.75), 20.0),
        _place(trimesh.creation.box((0.6, 0.5, 0.6)), white, (0.6, 0.25, -0.45), -17.0),
        _place(trimesh.creation.torus(0.2, 0.075), Material((0.80, 0.52, 0.12)), (0.6, 0.578, -0.45), smooth=True),
        _place(trimesh.creation.icosphere(4, 0.3), Material((0.25, 0.55, 0.20)), (-0.3, 0.3, 0.2), smooth=True),
        _lattice(Material((0.30, 0.22, 0.16))),
    ]
    keyframes = [_orbit(angle) for angle in (-16.0, -8.0, 0.0, 8.0, 16.0)]
    return Scene(instances, camera_path=CameraPath.through(keyframes))


BUILTIN: dict[str, Callable[[], Scene]] = {"cornell": cornell}


def _orbit(degrees: float) -> Camera:
    """A camera inside the open front that swings around the middle of the room and moves in a little."""
    angle = np.radians(degrees)
    radius = 3.6 - 0.012 * degrees
    eye = vector((radius * np.sin(angle), 1.05 + 0.006 * degrees, -0.6 + radius * np.cos(angle)))
    return Camera(eye, (0.0, 0.95, -0.6), fov_y=42.0)


def _quad(corner: Vector, right: Vector, up: Vector, material: Material) -> Instance:
    """A rectangle; its texture's lower left texel lies at `corner`."""
    a, b, c = np.array(corner, float), np.array(right, float), np.array(up, float)
    square = np.array([[[0, 0], [1, 0], [1, 1]], [[0, 0], [1, 1], [0, 1]]], float)
    return Instance(a + square[..., :1] * b + square[..., 1:] * c, material, uv=square)


def _place(
    mesh: trimesh.Trimesh, material: Material, position: Vector, degrees: float = 0.0, *, smooth: bool = False
) -> Instance:
    """A mesh made by trimesh, whose axis is z, stood up, turned about the vertical and moved."""
    mesh = mesh.copy()
    if smooth:
        mesh.apply_transform(rotation_matrix(-np.pi / 2.0, (1, 0, 0)))
    mesh.apply_transform(rotation_matrix(np.radians(degrees), UP))
    mesh.apply_transform(translation_matrix(position))
    return Instance(mesh.triangles, material, mesh.vertex_normals[mesh.faces] if smooth else None)


def _lattice(material: Material) -> Instance:
    """A screen of thin upright bars in front of the right wall."""
    bars = []
    for index in range(9):
        z = -1.2 + 0.16 * index
        bars.append(trimesh.creation.cylinder(0.012, segment=((1.35, 0.0, z), (1.35, 1.3, z)), sections=10))
    for y in (0.08, 1.3):
        bars.append(trimesh.creation.box((0.04, 0.04, 1.36), translation_matrix((1.35, y, -0.56))))
    return Instance(np.concatenate([bar.triangles for bar in bars]), material)


def _tiles() -> Image:
    """A floor of 14 by 19 tiles in two tones, each a little different, with pale joints."""
    columns, rows, size, joint = 14, 19, 32, 1
    random = np.random.default_rng(7)
    y, x = np.mgrid[: rows * size, : columns * size]
    dark = ((x // size + y // size) % 2)[..., None]
    colour = np.where(dark, (96.0, 84.0, 78.0), (214.0, 204.0, 186.0))
    colour *= random.uniform(0.9, 1.06, (rows, columns, 1))[y // size, x // size]
    colour += random.normal(0.0, 4.0, (*x.shape, 1))
    joints = (np.minimum(x % size, y % size) < joint)[..., None]
    return np.where(joints, (170.0, 164.0, 152.0), colour).clip(0, 255).astype(np.uint8)


def _painting() -> Image:
    """A picture for the back wall: a low sun, with rings, over waves, in a dark frame."""
    height, width = 256, 416
    y, x = np.mgrid[1.0 : 0.0 : height * 1j, 0.0 : width / height : width * 1j]
    sky = np.stack([0.95 - 0.35 * y, 0.62 - 0.30 * y, 0.35 + 0.25 * y], axis=-1)
    distance = np.hypot(x - 1.05, y - 0.42)
    rings = 0.10 * (np.floor(distance * 14.0) % 2) * (distance < 0.85)
    sky += rings[..., None]
    sky[distance < 0.2] = (1.0, 0.90, 0.62)
    for level in range(5):
        crest = 0.44 - 0.08 * level + 0.025 * np.sin(x * (9.0 - level) + 1.7 * level)
        sky[y < crest] = np.array((0.10, 0.36, 0.46)) * (1.15 - 0.19 * level)
    border = np.minimum(np.minimum(y, 1.0 - y), np.minimum(x, width / height - x)) < 0.045
    sky[border] = (0.12, 0.09, 0.07)
    return (sky.clip(0.0, 1.0) * 255.0).astype(np.uint8)
