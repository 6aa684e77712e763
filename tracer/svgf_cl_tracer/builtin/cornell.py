"""The open box in which light bounces between coloured walls: the demo's scene."""

from __future__ import annotations

import numpy as np

from ..camera import Camera, CameraPath, vector
from ..geometry import Instance
from ..materials import Material
from ..scene import Scene
from ..textures import Image
from .patterns import tiles
from .shapes import ball, box, merged, place, quad, ring, rod

# Half width, height, back and front of the room, in scene units; its front is open.
HALF_WIDTH, HEIGHT, BACK, FRONT = 1.75, 2.0, -1.5, 3.2


def make() -> Scene:
    """An open box with coloured walls, two blocks, a ball, a ring, a lattice and a tiled floor under one lamp."""
    white = Material((0.73, 0.72, 0.69))
    w, h, b, f = HALF_WIDTH, HEIGHT, BACK, FRONT
    lamp = Material((0.0, 0.0, 0.0), emission=(17.0, 13.0, 8.5))
    floor = tiles(14, 19, dark=(96, 84, 78), light=(214, 204, 186), joint=(170, 164, 152))
    instances = [
        quad((-w, 0, f), (2 * w, 0, 0), (0, 0, b - f), Material((1.0, 1.0, 1.0), base_texture=floor)),
        quad((-w, h, b), (2 * w, 0, 0), (0, 0, f - b), white),
        quad((-w, 0, b), (2 * w, 0, 0), (0, h, 0), white),
        quad((-w, 0, f), (0, 0, b - f), (0, h, 0), Material((0.63, 0.09, 0.06))),
        quad((w, 0, b), (0, 0, f - b), (0, h, 0), Material((0.08, 0.30, 0.36))),
        quad((-0.5, h - 0.01, -0.35), (1.0, 0, 0), (0, 0, 0.75), lamp),
        quad((-0.5, 0.75, b + 0.01), (1.3, 0, 0), (0, 0.8, 0), Material((1.0, 1.0, 1.0), base_texture=_painting())),
        place(box((0.55, 1.15, 0.55)), white, (-0.85, 0.575, -0.75), 20.0),
        place(box((0.6, 0.5, 0.6)), white, (0.6, 0.25, -0.45), -17.0),
        ring(0.2, 0.075, (0.6, 0.578, -0.45), Material((0.80, 0.52, 0.12))),
        ball(0.3, (-0.3, 0.3, 0.2), Material((0.25, 0.55, 0.20))),
        _lattice(Material((0.30, 0.22, 0.16))),
    ]
    keyframes = [_orbit(angle) for angle in (-16.0, -8.0, 0.0, 8.0, 16.0)]
    return Scene(instances, camera_path=CameraPath.through(keyframes))


def _orbit(degrees: float) -> Camera:
    """A camera inside the open front that swings around the middle of the room and moves in a little."""
    angle = np.radians(degrees)
    radius = 3.6 - 0.012 * degrees
    eye = vector((radius * np.sin(angle), 1.05 + 0.006 * degrees, -0.6 + radius * np.cos(angle)))
    return Camera(eye, (0.0, 0.95, -0.6), fov_y=42.0)


def _lattice(material: Material) -> Instance:
    """A screen of thin upright bars in front of the right wall."""
    depths = [-1.2 + 0.16 * index for index in range(9)]
    bars = [rod((1.35, 0.0, z), (1.35, 1.3, z), 0.012) for z in depths]
    return merged([*bars, *(box((0.04, 0.04, 1.36), (1.35, y, -0.56)) for y in (0.08, 1.3))], material)


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
