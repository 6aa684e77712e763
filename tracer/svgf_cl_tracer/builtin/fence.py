"""A garden behind an iron fence: much that is thinner than a pixel."""

from __future__ import annotations

import numpy as np
import trimesh

from ..camera import Camera, CameraPath
from ..lights import Sun
from ..materials import Material
from ..scene import Scene
from ..textures import Image
from .foliage import foliage
from .patterns import bricks, clouds, image, mixed, plaster
from .shapes import box, lathe, merged, quad, rod
from .surfaces import glazed, painted

TRUNK = [(0.0, 0.0), (0.24, 0.0), (0.15, 0.3), (0.11, 1.6), (0.0, 2.4)]


def make() -> Scene:
    """A cottage with a grille before its window, a tree and a hedge; an iron fence and netting in front."""
    iron, white = Material((0.05, 0.05, 0.06)), Material((0.75, 0.74, 0.70))
    lawn = image(mixed(clouds((512, 512), 31, slope=0.9), (34, 62, 20), (112, 142, 58)))
    wall = painted(plaster(512, 33, (196, 176, 146), (238, 226, 202)))
    roof = painted(bricks(16, 32, (84, 36, 28), (134, 62, 44), (60, 30, 26)))
    netting = Material(base_texture=_netting(), alpha_cutoff=0.5)
    instances = [
        quad((-12, 0, 4), (24, 0, 0), (0, 0, -18), painted(lawn), repeat=(6, 4.5)),
        quad((-0.8, 0, -3), (4.4, 0, 0), (0, 2.6, 0), wall, repeat=(1.6, 1)),
        quad((-0.8, 0, -7), (0, 0, 4), (0, 2.6, 0), wall),
        quad((-1.1, 2.45, -2.7), (5.0, 0, 0), (0, 1.3, -1.6), roof, repeat=(2, 1)),
        quad((0.5, 0.9, -2.99), (1.3, 0, 0), (0, 1.1, 0), glazed((0.04, 0.05, 0.07), 0.1)),
        merged([box((1.46, 0.08, 0.1), (1.15, y, -2.97)) for y in (0.87, 2.03)], white),
        merged([box((0.08, 1.16, 0.1), (x, 1.45, -2.97)) for x in (0.46, 1.84)], white),
        merged(_grille(), iron),
        merged(_railings(), iron),
        quad((0.0, 0.15, 1.2), (3.0, 0, 0), (0, 0.83, 0), netting, repeat=(60, 16.6)),
        lathe(TRUNK, Material((0.20, 0.13, 0.08)), (-2.2, 0.0, -1.6)),
        foliage(1500, (-2.2, 2.5, -1.6), (1.5, 1.1, 1.3), seed=1),
        foliage(700, (3.3, 0.55, -1.9), (1.3, 0.75, 0.5), seed=2),
    ]
    sun = Sun((-0.55, 0.75, 0.6), (9.0, 8.2, 6.8), angular_radius=0.27)
    path = CameraPath.through(
        [Camera((x, 1.35, 3.4), (0.3 * x + 0.1, 1.25, -2.0), fov_y=45.0) for x in (-0.5, 0.0, 0.5)]
    )
    return Scene(instances, lights=[sun], sky=(0.65, 0.85, 1.2), camera_path=path)


def _grille() -> list[trimesh.Trimesh]:
    """Crossed bars before the window."""
    upright = [rod((x, 0.9, -2.88), (x, 2.0, -2.88), 0.006) for x in np.linspace(0.5, 1.8, 14)]
    level = [rod((0.5, y, -2.88), (1.8, y, -2.88), 0.006) for y in np.linspace(0.95, 1.95, 6)]
    return upright + level


def _railings() -> list[trimesh.Trimesh]:
    """An iron fence across the picture."""
    bars = [rod((x, 0.0, 1.2), (x, 1.12, 1.2), 0.009) for x in np.arange(-3.0, 3.01, 0.12)]
    return bars + [box((6.2, 0.03, 0.03), (0.0, y, 1.2)) for y in (0.15, 0.98)]


def _netting() -> Image:
    """One mesh of a net (h, w, 4): grey wire along both diagonals, and nothing else."""
    y, x = np.mgrid[:64, :64] / 64.0
    wire = np.minimum(abs((x + y) % 1.0 - 0.5), abs((x - y) % 1.0 - 0.5)) < 0.04
    return image(np.where(wire[..., None], (130, 134, 136, 255), (130, 134, 136, 0)))
