"""A studio with a polished floor: reflections move differently from the surface that shows them."""

from __future__ import annotations

from ..camera import CameraPath
from ..materials import Material
from ..scene import Scene
from .patterns import marble
from .shapes import ball, curve, lathe, merged, orbit, panel, quad, ring, rod
from .surfaces import GLASS, glazed, lamp, metal

VASE = [(0.0, 0.0), (0.16, 0.0), (0.30, 0.28), (0.22, 0.62), (0.09, 0.82), (0.14, 0.95), (0.12, 0.96), (0.0, 0.7)]


def make() -> Scene:
    """Copper balls from smooth to rough, a golden vase, a glass ball and bright rods on black marble."""
    stone = Material(base_texture=marble(512, 21, (30, 28, 32), (206, 196, 180)), roughness=0.2, ior=1.5)
    instances = [
        quad((-7, 0, 5), (14, 0, 0), (0, 0, -8), stone, repeat=(4.2, 2.4)),
        quad((-7, 0, -3), (14, 0, 0), (0, 5, 0), Material((0.20, 0.21, 0.25))),
        panel((-1.2, 3.6, 0.6), (0.0, 0.4, 0.0), (1.8, 1.2), lamp(52, 49, 46)),
        panel((3.2, 1.7, 1.0), (0.0, 0.6, 0.0), (0.3, 2.2), lamp(44, 58, 86)),
        lathe(curve(VASE), metal((1.0, 0.71, 0.29), 0.25), (-1.35, 0.0, -0.5)),
        ball(0.26, (-0.75, 0.26, 0.75), GLASS),
        ring(0.2, 0.06, (1.35, 0.06, 0.7), glazed((0.85, 0.10, 0.07))),
    ]
    for index, roughness in enumerate((0.05, 0.2, 0.4, 0.7)):
        position = (-0.45 + 0.68 * index, 0.28, -0.3 - 0.12 * index)
        instances.append(ball(0.28, position, metal((0.95, 0.64, 0.54), roughness)))
    for index, colour in enumerate(((0.9, 0.1, 0.08), (0.95, 0.55, 0.05), (0.1, 0.6, 0.25), (0.08, 0.35, 0.8))):
        x = -2.1 + 1.4 * index
        instances.append(merged([rod((x, 0.0, -1.9), (x, 2.2 - 0.3 * index, -1.9), 0.05)], Material(colour)))
    path = CameraPath.through(orbit((0.0, 0.55, -0.3), 4.6, 0.7, (-14.0, 0.0, 14.0), 38.0))
    return Scene(instances, camera_path=path)
