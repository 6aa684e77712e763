"""A dark arcade beside a court in the sun: radiance spans three orders of magnitude in one picture."""

from __future__ import annotations

import numpy as np

from ..camera import Camera, CameraPath
from ..geometry import Instance
from ..lights import Sun
from ..materials import Material
from ..scene import Scene
from .patterns import bricks, plaster, tiles
from .shapes import band, curve, lathe, quad
from .surfaces import glazed, painted

BAYS, BAY = 5, 2.0  # the number of bays, and the length of each
PASSAGE = 5.0  # length of the walk beyond the arches
SPRING, TOP = 2.0, 3.4  # heights of the springing of the arches and of the top of the wall
HALF = 1.6  # half of the walk's width

COLUMN = [(0.0, 0.0), (0.24, 0.0), (0.24, 0.12), (0.16, 0.2), (0.14, 1.75), (0.2, 1.85), (0.26, 2.0), (0.0, 2.0)]
URN = [(0.0, 0.0), (0.16, 0.0), (0.08, 0.1), (0.3, 0.45), (0.28, 0.7), (0.14, 0.82), (0.2, 0.9), (0.0, 0.8)]
CYPRESS = [(0.0, 0.0), (0.12, 0.0), (0.12, 0.4), (0.5, 0.8), (0.42, 2.0), (0.0, 4.5)]


def make() -> Scene:
    """A walk along the arcade, towards its unlit end; cypresses in the court."""
    stone = painted(plaster(512, 61, (160, 138, 108), (206, 186, 152)))
    floor = painted(tiles(8, 24, (104, 82, 66), (182, 160, 130), (96, 84, 70)))
    brick = painted(bricks(16, 32, (72, 48, 40), (124, 88, 70), (104, 96, 88)))
    end = -BAY * BAYS - PASSAGE
    instances = [
        quad((-HALF, 0, 2), (2 * HALF, 0, 0), (0, 0, end - 2), floor, repeat=(0.5, 0.75)),
        quad((-HALF, TOP, end), (2 * HALF, 0, 0), (0, 0, 2 - end), stone, repeat=(1, 4)),
        quad((-HALF, 0, 2), (0, 0, end - 2), (0, TOP, 0), brick, repeat=(5, 1)),
        quad((-HALF, 0, end), (2 * HALF, 0, 0), (0, TOP, 0), Material((0.10, 0.07, 0.06))),
        quad((HALF, 0, end), (0, 0, PASSAGE), (0, TOP, 0), stone),
        quad((HALF, -0.05, 2), (9, 0, 0), (0, 0, end - 7), Material((0.55, 0.47, 0.34))),
        quad((HALF, 0, end - 5), (9, 0, 0), (0, 2.6, 0), Material((0.66, 0.50, 0.36))),
        *(_arch((HALF, 0.0, -BAY * bay), stone) for bay in range(BAYS)),
        *(lathe(COLUMN, stone, (HALF, 0.0, -BAY * bay)) for bay in range(BAYS)),
        *(lathe(curve(URN), glazed((0.36, 0.15, 0.09)), (-1.15, 0.0, z)) for z in (-3.0, -8.0)),
        *(lathe(curve(CYPRESS), Material((0.07, 0.12, 0.05)), (5.0, 0.0, z)) for z in (-7.0, -11.0, -15.0, -19.0)),
    ]
    sun = Sun((0.8, 0.9, 0.1), (60.0, 54.0, 44.0), angular_radius=0.27)
    path = [Camera((-0.3, 1.6, z), (0.1, 1.4, z - 6.0), fov_y=50.0) for z in (1.2, 0.2)]
    return Scene(instances, lights=[sun], sky=(2.2, 3.0, 4.4), camera_path=CameraPath.through(path))


def _arch(corner: tuple[float, float, float], material: Material) -> Instance:
    """The wall above a round arch that spans one bay from `corner` backwards: both faces and the vault between."""
    angle = np.linspace(0.0, np.pi, 25)
    x, z = np.full_like(angle, 0.2), -0.5 * BAY * (1.0 - np.cos(angle))
    vault, top = SPRING + 0.5 * BAY * np.sin(angle), np.full_like(angle, TOP)
    inner, outer = (np.stack([side, vault, z], axis=1) + corner for side in (-x, x))
    inner_top, outer_top = (np.stack([side, top, z], axis=1) + corner for side in (-x, x))
    corners = np.concatenate([band(inner, inner_top), band(outer, outer_top), band(inner, outer)])
    return Instance(corners, material, uv=0.25 * corners[..., [2, 1]])
