"""A pendulum swings across the room: it uncovers new surfaces, and its shadow moves over still ones."""

from __future__ import annotations

import numpy as np

from ..camera import Camera, CameraPath
from ..materials import Material
from ..motion import Motion
from ..scene import Scene
from ..textures import Image
from .patterns import bricks, clouds, image, mixed
from .shapes import lathe, merged, panel, quad, rod
from .surfaces import lamp, metal, painted

PIVOT = (0.0, 3.6, 0.0)
PERIOD = 2.0  # seconds
SWING = 26.0  # degrees to either side
PHASE = 0.8  # radians; in the middle of the sequence the pendulum is moving

BOB = [(0.0, 0.0), (0.02, 0.06), (0.3, 0.32), (0.3, 0.40), (0.1, 0.56), (0.0, 0.58)]


def make() -> Scene:
    """Foucault's pendulum above a compass rose, in a ring of pegs, under one small lamp."""
    times = np.linspace(0.0, PERIOD, 49)
    motion = Motion.turning(PIVOT, (0, 0, 1), times, SWING * np.cos(2.0 * np.pi * times / PERIOD + PHASE), repeats=True)
    wall = painted(bricks(16, 32, (116, 58, 44), (186, 112, 84), (176, 168, 156)))
    angles = np.radians(np.arange(0.0, 360.0, 15.0))
    feet = [(1.5 * float(np.cos(angle)), 0.0, 1.5 * float(np.sin(angle))) for angle in angles]
    instances = [
        quad((-4, 0, 4), (8, 0, 0), (0, 0, -8), painted(_compass_rose())),
        quad((-4, 0, -2.5), (8, 0, 0), (0, 4, 0), wall),
        quad((-4, 0, 4), (0, 0, -6.5), (0, 4, 0), wall),
        quad((4, 0, -2.5), (0, 0, 6.5), (0, 4, 0), wall),
        panel((1.4, 3.9, 2.2), (0.0, 0.0, -0.4), (0.35, 0.35), lamp(640, 560, 440)),
        lathe(BOB, metal((0.83, 0.60, 0.22), 0.35), (0.0, 0.12, 0.0), motion=motion),
        merged([rod((0, 0.68, 0), PIVOT, 0.012)], Material((0.2, 0.2, 0.22)), motion=motion),
        *(lathe([(0, 0), (0.04, 0), (0.03, 0.24), (0, 0.26)], Material((0.75, 0.72, 0.65)), foot) for foot in feet),
    ]
    camera = Camera((0.3, 1.9, 4.3), (0.0, 0.75, -0.3), fov_y=42.0)
    return Scene(instances, sky=(0.5, 0.56, 0.7), camera_path=CameraPath.static(camera))


def _compass_rose() -> Image:
    """A star of 16 points in a ring, inlaid in stone."""
    y, x = np.mgrid[4.0:-4.0:1024j, -4.0:4.0:1024j]
    radius, turn = np.hypot(x, y), np.arctan2(y, x) / (2.0 * np.pi)
    stone = mixed(clouds(x.shape, 17, slope=1.0), (150, 138, 122), (206, 194, 174))
    for points, reach, light, dark in (
        (16, 1.1, (120, 88, 60), (90, 62, 44)),
        (8, 1.2, (214, 178, 120), (60, 66, 84)),
        (4, 1.3, (170, 44, 34), (38, 40, 52)),
    ):
        spoke = (turn * points + 0.5) % 1.0 - 0.5
        star = radius * (1.0 + 5.0 * abs(spoke)) < reach
        stone[star] = np.where(spoke[star, None] > 0.0, light, dark)
    for ring in (1.38, 1.66):
        stone[abs(radius - ring) < 0.03] = (52, 48, 50)
    return image(stone)
