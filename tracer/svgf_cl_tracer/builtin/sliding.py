"""A painted wall slides past: its pattern moves with it, but the shadows on it do not."""

from __future__ import annotations

import numpy as np

from ..camera import Camera, CameraPath
from ..materials import Material
from ..motion import Motion
from ..scene import Scene
from ..vectors import Float64
from .patterns import image, mixed, planks
from .shapes import box, lathe, merged, panel, quad
from .surfaces import lamp, painted

SPEED = 1.8  # units per second, to the left
LENGTH = 12.0  # length after which the painting repeats

COLUMN = [(0.0, 0.0), (0.24, 0.0), (0.24, 0.1), (0.15, 0.18), (0.135, 2.6), (0.22, 2.75), (0.24, 2.9), (0.0, 2.9)]


def make() -> Scene:
    """Two columns cast their shadows on a long wall of painted tiles that moves behind them."""
    motion = Motion.sliding((0.0, 10.0), ((0, 0, 0), (-10.0 * SPEED, 0, 0)))
    frieze = np.concatenate([_meander(), _sea(), _blue_tiles()])
    stone = Material((0.72, 0.68, 0.60))
    instances = [
        quad((-6, 0, 5), (12, 0, 0), (0, 0, -7), painted(planks(16, (92, 62, 40), (176, 132, 88))), repeat=(2, 1)),
        quad((-LENGTH, 0, -1.2), (3 * LENGTH, 0, 0), (0, 2.9, 0), painted(image(frieze)), repeat=(3, 1), motion=motion),
        panel((1.6, 3.0, 3.4), (0.0, 1.2, -1.2), (0.5, 0.5), lamp(340, 306, 256)),
        merged([box((12.0, 0.35, 0.5), (0.0, 3.075, 0.3))], stone),
        *(lathe(COLUMN, stone, (x, 0.0, 0.3)) for x in (-1.5, 1.5)),
        merged(
            [box((1.5, 0.08, 0.4), (0, 0.45, 0.2)), *(box((0.1, 0.42, 0.34), (x, 0.21, 0.2)) for x in (-0.6, 0.6))],
            Material((0.25, 0.32, 0.30)),
        ),
    ]
    camera = Camera((-0.5, 1.45, 4.4), (0.0, 1.3, -1.2), fov_y=42.0)
    return Scene(instances, sky=(0.25, 0.3, 0.4), camera_path=CameraPath.static(camera))


def _sea() -> Float64:
    height, width = 260, 1920
    y, x = np.mgrid[1.0 : 0.0 : height * 1j, 0.0 : 2.0 * np.pi : width * 1j]
    colour = mixed(y, (246, 190, 118), (88, 132, 176))
    for sun in (1.2, 3.3, 5.4):
        distance = np.hypot((x - sun) * 1.1, y - 0.55)
        colour += 22.0 * (np.floor(distance * 16.0) % 2 * (distance < 0.75))[..., None]
        colour[distance < 0.2] = (255, 232, 168)
    for level in range(6):
        crest = 0.5 - 0.085 * level + 0.03 * np.sin(x * (21 - 2 * level) + 1.7 * level) + 0.02 * np.sin(x * 3 + level)
        colour[y < crest] = np.array((58, 118, 138)) * (1.15 - 0.16 * level)
    return colour


def _blue_tiles() -> Float64:
    """48 tiles around, 4 high; each has the same flower, mirrored at its edges."""
    y, x = np.mgrid[:160, :1920] / 40.0
    u, v = abs(x % 1.0 - 0.5), abs(y % 1.0 - 0.5)
    radius, angle = np.hypot(u, v), np.arctan2(v, u)
    petals = radius < 0.3 + 0.14 * np.cos(4.0 * angle)
    blue = petals ^ (radius < 0.14) | (np.maximum(u, v) > 0.47) | (abs(u + v - 0.8) < 0.05)
    return mixed(blue.astype(float), (232, 230, 220), (34, 66, 132))


def _meander() -> Float64:
    key = np.array(
        [list(row) for row in ("########", "#......#", "#.####.#", "#.#..#.#", "#.##.#.#", "......#.", "########")]
    )
    band = np.tile((key == "#").repeat(6, 0).repeat(6, 1), (1, 40)).astype(float)
    return mixed(band, (222, 206, 170), (120, 52, 36))
