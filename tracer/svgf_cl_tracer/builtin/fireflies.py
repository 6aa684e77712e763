"""Two tiny lamps in bowls: all light comes from a few very bright spots, which paths rarely hit."""

from __future__ import annotations

from ..camera import CameraPath
from ..materials import Material
from ..scene import Scene
from .patterns import plaster, tiles
from .shapes import ball, box, curve, lathe, orbit, place, quad, ring
from .surfaces import glazed, lamp, painted

BOWL = [(0.0, 0.0), (0.08, 0.02), (0.2, 0.14), (0.21, 0.14), (0.19, 0.14), (0.07, 0.035), (0.0, 0.03)]
AMPHORA = [(0.0, 0.0), (0.08, 0.0), (0.07, 0.03), (0.24, 0.42), (0.20, 0.66), (0.07, 0.8), (0.12, 0.92), (0.0, 0.85)]


def make() -> Scene:
    """A night in a museum: an amphora between two uplights whose lamps cannot be seen."""
    wall, white = painted(plaster(512, 41, (150, 96, 70), (196, 138, 104))), Material((0.8, 0.78, 0.74))
    instances = [
        quad(
            (-2.5, 0, 3), (5, 0, 0), (0, 0, -4.5), painted(tiles(16, 16, (58, 52, 50), (150, 136, 118), (92, 84, 76)))
        ),
        quad((-2.5, 3, -1.5), (5, 0, 0), (0, 0, 4.5), white),
        quad((-2.5, 0, -1.5), (5, 0, 0), (0, 3, 0), wall),
        quad((-2.5, 0, 3), (0, 0, -4.5), (0, 3, 0), wall),
        quad((2.5, 0, -1.5), (0, 0, 4.5), (0, 3, 0), wall),
        place(box((0.6, 0.7, 0.6)), white, (0.0, 0.35, -0.8), 12.0),
        lathe(curve(AMPHORA), glazed((0.42, 0.17, 0.09), 0.4), (0.0, 0.7, -0.8)),
        ball(0.2, (0.85, 0.2, -0.35), Material((0.16, 0.36, 0.34))),
        ring(0.24, 0.07, (-0.85, 0.07, -0.3), Material((0.75, 0.5, 0.16))),
    ]
    for x in (-1.5, 1.5):
        instances.append(lathe(BOWL, Material((0.28, 0.20, 0.12)), (x, 1.75, -1.25)))
        instances.append(quad((x - 0.006, 1.80, -1.244), (0.012, 0, 0), (0, 0, -0.012), lamp(6e5, 4.2e5, 2.4e5)))
    path = CameraPath.through(orbit((0.0, 1.15, -1.0), 3.9, 0.2, (-8.0, 8.0), 42.0))
    return Scene(instances, camera_path=path)
