"""A still life: nothing moves, so all flicker comes from the filter."""

from __future__ import annotations

from ..camera import Camera, CameraPath
from ..materials import Material
from ..scene import Scene
from .patterns import planks, plaster
from .shapes import ball, box, curve, lathe, merged, place, quad
from .surfaces import GLASS, glazed, lamp, painted

BOTTLE = [(0.0, 0.0), (0.075, 0.0), (0.08, 0.02), (0.08, 0.2), (0.03, 0.3), (0.027, 0.38), (0.033, 0.39), (0.0, 0.4)]
BOWL = [(0.0, 0.0), (0.07, 0.0), (0.06, 0.02), (0.17, 0.1), (0.2, 0.13), (0.16, 0.1), (0.0, 0.04)]
JUG = [(0.0, 0.0), (0.08, 0.0), (0.12, 0.1), (0.09, 0.22), (0.06, 0.27), (0.08, 0.32), (0.07, 0.32), (0.0, 0.2)]

# Radius, centre, colour.
FRUIT = (
    (0.052, (0.04, 0.115, 0.06), (0.88, 0.38, 0.04)),
    (0.050, (0.16, 0.115, 0.07), (0.85, 0.34, 0.04)),
    (0.048, (0.10, 0.110, -0.05), (0.80, 0.30, 0.05)),
    (0.045, (0.11, 0.185, 0.03), (0.45, 0.58, 0.10)),
    (0.047, (0.37, 0.047, 0.18), (0.62, 0.07, 0.05)),
)
BOOKS = ((0.42, 0.10, 0.08), (0.10, 0.20, 0.24), (0.58, 0.44, 0.18))


def make() -> Scene:
    """Fruit, a bottle, a jug, books and a glass ball on a table beside a window."""
    table = Material(base_texture=planks(6, (84, 54, 34), (168, 118, 76)), roughness=0.5, ior=1.4)
    bars = [box((0.04, 1.1, 0.04), (-1.46, 0.6, z)) for z in (0.1, 0.5)]
    instances = [
        quad((-1.4, 0, 0.8), (2.8, 0, 0), (0, 0, -1.4), table),
        quad((-2, -1, -0.7), (4, 0, 0), (0, 3, 0), painted(plaster(512, 51, (92, 100, 98), (136, 140, 130)))),
        quad((-1.5, 0.05, 0.9), (0, 0, -1.2), (0, 1.1, 0), lamp(34, 36, 41)),
        merged([box((0.04, 0.04, 1.2), (-1.46, 0.6, 0.3)), *bars], Material((0.75, 0.73, 0.68))),
        lathe(curve(BOTTLE), glazed((0.03, 0.09, 0.04), 0.1), (-0.42, 0.0, -0.18)),
        lathe(curve(JUG), glazed((0.82, 0.80, 0.74)), (-0.17, 0.0, -0.25)),
        lathe(curve(BOWL), glazed((0.16, 0.26, 0.42)), (0.1, 0.0, 0.02)),
        ball(0.07, (-0.28, 0.07, 0.2), GLASS),
        *(ball(radius, centre, glazed(colour, 0.4)) for radius, centre, colour in FRUIT),
    ]
    for index, colour in enumerate(BOOKS):
        cover, position = box((0.3, 0.045, 0.2)), (0.52, 0.0225 + 0.045 * index, -0.2)
        instances.append(place(cover, Material(colour), position, 14.0 * index - 8.0))
    camera = Camera((0.15, 0.42, 1.35), (0.03, 0.13, -0.1), fov_y=36.0)
    return Scene(instances, sky=(0.25, 0.27, 0.3), camera_path=CameraPath.static(camera))
