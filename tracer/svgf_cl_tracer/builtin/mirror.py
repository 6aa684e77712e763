"""A hall of mirrors: the edges, depth and motion in a reflection are not those of the mirror."""

from __future__ import annotations

import numpy as np

from ..camera import Camera, CameraPath
from ..geometry import Instance
from ..materials import Material
from ..scene import Scene
from .patterns import image, tiles
from .shapes import ball, box, curve, lathe, place, quad
from .surfaces import glazed, lamp, metal, painted

URN = [(0.0, 0.0), (0.13, 0.0), (0.06, 0.1), (0.2, 0.32), (0.22, 0.45), (0.12, 0.52), (0.16, 0.58), (0.0, 0.5)]


def make() -> Scene:
    """Three tall mirrors in golden frames, an urn and balls before them, a striped wall behind the camera."""
    floor = tiles(12, 12, dark=(40, 44, 52), light=(224, 220, 208), joint=(120, 118, 112))
    stripes = np.array([(172, 62, 44), (226, 202, 160), (44, 92, 110), (226, 202, 160)]).repeat(32, axis=0)
    wall, day = Material((0.42, 0.50, 0.44)), lamp(15, 16, 18)
    instances = [
        quad((-3, 0, 3), (6, 0, 0), (0, 0, -6), painted(floor)),
        quad((-3, 3, -3), (6, 0, 0), (0, 0, 6), Material((0.8, 0.79, 0.75))),
        quad((-3, 0, -3), (6, 0, 0), (0, 3, 0), wall),
        quad((3, 0, 3), (-6, 0, 0), (0, 3, 0), painted(image(stripes[None])), repeat=(5, 1)),
        quad((-3, 0, 3), (0, 0, -6), (0, 3, 0), wall),
        quad((3, 0, -3), (0, 0, 6), (0, 3, 0), wall),
        quad((-2.98, 0.9, -0.8), (0, 0, -1.5), (0, 1.7, 0), day),
        quad((2.98, 0.9, 0.0), (0, 0, 1.5), (0, 1.7, 0), day),
        place(box((0.5, 0.8, 0.5)), Material((0.72, 0.70, 0.66)), (-0.55, 0.4, -1.4), 25.0),
        lathe(curve(URN), glazed((0.66, 0.12, 0.08)), (-0.55, 0.8, -1.4)),
        ball(0.32, (0.75, 0.32, -1.3), glazed((0.06, 0.16, 0.40))),
        ball(0.16, (0.15, 0.16, -0.7), glazed((0.85, 0.55, 0.10))),
    ]
    for x, degrees in ((-1.5, 18.0), (0.0, 0.0), (1.5, -18.0)):
        instances += _mirror((x, 0.0, -2.55), degrees)
    path = [Camera((x, 1.45, 2.3), (0.35 * x, 1.15, -2.0), fov_y=50.0) for x in (-0.9, 0.0, 0.9)]
    return Scene(instances, camera_path=CameraPath.through(path))


def _mirror(foot: tuple[float, float, float], degrees: float) -> list[Instance]:
    """A standing mirror, 0.9 by 2.1, and its frame, turned about the vertical."""
    silver, gold = metal((0.93, 0.94, 0.93), 0.0), Material((0.80, 0.58, 0.22))
    sides = [box((0.07, 2.2, 0.08), (side, 1.15, 0.0)) for side in (-0.48, 0.48)]
    ends = [box((1.03, 0.07, 0.08), (0.0, height, 0.0)) for height in (0.08, 2.22)]
    pane = place(box((0.9, 2.1, 0.02), (0.0, 1.15, 0.0)), silver, foot, degrees)
    return [pane, *(place(bar, gold, foot, degrees) for bar in (*sides, *ends))]
