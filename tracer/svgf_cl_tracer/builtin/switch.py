"""A lamp is switched off and on again: a filter that trusts its history for too long lags behind."""

from __future__ import annotations

import numpy as np

from ..camera import Camera, CameraPath
from ..materials import Material
from ..motion import Track
from ..scene import Scene
from .patterns import image, planks
from .shapes import ball, box, curve, lathe, merged, quad, rod
from .surfaces import glazed, lamp, painted

# Seconds at which the lamp is switched.
OFF, ON = 0.5, 1.0

LANTERN = (0.75, 1.65, -0.75)

TABLE = [(0.0, 0.0), (0.2, 0.0), (0.18, 0.03), (0.03, 0.07), (0.03, 0.56), (0.32, 0.59), (0.32, 0.63), (0.0, 0.63)]
VASE = [(0.0, 0.0), (0.06, 0.0), (0.12, 0.11), (0.04, 0.27), (0.06, 0.32), (0.0, 0.25)]


def make() -> Scene:
    """A paper lantern beside a bed at dusk; the weak light from the window does not change."""
    paper = Material(emission=(22.0, 15.5, 8.6), brightness=Track((0.0, OFF, ON), ((1,), (0,), (1,)), step=True))
    stripes = image(np.array([(186, 176, 150), (128, 142, 132)]).repeat(16, axis=0)[None])
    white, wood = Material((0.75, 0.74, 0.70)), glazed((0.30, 0.16, 0.09), 0.5)
    linen, wool = Material((0.78, 0.76, 0.70)), Material((0.46, 0.10, 0.08))
    instances = [
        quad((-2.5, 0, 3), (5, 0, 0), (0, 0, -4.5), painted(planks(14, (70, 44, 30), (142, 98, 62)))),
        quad((-2.5, 2.6, -1.5), (5, 0, 0), (0, 0, 4.5), white),
        quad((-2.5, 0, -1.5), (5, 0, 0), (0, 2.6, 0), painted(stripes), repeat=(24, 1)),
        quad((-2.5, 0, 3), (0, 0, -4.5), (0, 2.6, 0), white),
        quad((2.5, 0, -1.5), (0, 0, 4.5), (0, 2.6, 0), white),
        # The window and its bars.
        quad((-1.5, 1.35, -1.48), (1.0, 0, 0), (0, 0.95, 0), lamp(0.75, 1.15, 2.1)),
        merged([box((1.1, 0.06, 0.08), (-1.0, y, -1.48)) for y in (1.35, 2.3)], white),
        merged([box((0.06, 1.0, 0.08), (x, 1.825, -1.48)) for x in (-1.52, -1.0, -0.48)], white),
        # The bed: frame, mattress, blanket, pillows.
        merged([box((1.7, 0.95, 0.08), (-1.0, 0.5, -1.42)), box((1.6, 0.2, 2.1), (-1.0, 0.22, -0.35))], wood),
        merged([box((1.56, 0.2, 2.06), (-1.0, 0.42, -0.35))], linen),
        merged([box((1.62, 0.24, 1.4), (-1.0, 0.43, 0.0))], wool),
        merged([box((0.62, 0.16, 0.36), (x, 0.6, -1.1)) for x in (-1.38, -0.62)], linen),
        # The lantern, and a table below it.
        ball(0.27, LANTERN, paper),
        merged([rod(LANTERN, (LANTERN[0], 2.6, LANTERN[2]), 0.008)], wood),
        lathe(TABLE, wood, (0.4, 0.0, -1.05)),
        lathe(curve(VASE), glazed((0.10, 0.30, 0.34)), (0.4, 0.63, -1.05)),
        ball(0.2, (1.35, 0.2, -0.6), Material((0.08, 0.26, 0.30))),
    ]
    return Scene(instances, camera_path=CameraPath.static(Camera((0.6, 1.4, 2.7), (-0.25, 0.95, -1.2), fov_y=42.0)))
