"""Random rooms for training, so that the scenes for comparing filters need not be used for it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from svgf_cl_tracer import CameraPath, Scene
from svgf_cl_tracer.builtin import shapes
from svgf_cl_tracer.builtin.patterns import bricks, marble, planks, plaster, tiles
from svgf_cl_tracer.builtin.surfaces import glazed, lamp, metal, painted
from svgf_cl_tracer.geometry import Instance
from svgf_cl_tracer.materials import Colour, Material
from svgf_cl_tracer.motion import Motion
from svgf_cl_tracer.textures import Image

THINGS = 14  # in a room, in addition to walls and lamps
SECONDS = 2.0  # duration of motion


def room(seed: int) -> Scene:
    """A room whose size, paint, objects, lamps and camera path depend on `seed`; in every second room objects move."""
    return Builder(np.random.default_rng(seed), moves=seed % 2 == 1).scene()


@dataclass(frozen=True)
class Builder:
    """Makes the parts of a random room.

    Parameters
    ----------
    random : numpy.random.Generator
    moves : bool
        Whether some objects move.
    """

    random: np.random.Generator
    moves: bool

    def scene(self) -> Scene:
        """The whole room; it is open on the camera's side, where a faint sky shines in."""
        width, height, depth = self.random.uniform((4.0, 2.4, 4.0), (7.0, 3.6, 7.0))
        sky = self.random.uniform(0.02, 0.6, 3) if self.random.random() < 0.5 else np.zeros(3)
        things = [self.thing(width, depth) for _ in range(THINGS)]
        angles = self.random.uniform(-40, 40) + np.array((0.0, 1.0, 2.0)) * self.random.uniform(-8, 8)
        centre = (0.0, float(self.random.uniform(0.3, 0.9)), 0.0)
        radius, eye = self.random.uniform(0.36, 0.46) * min(width, depth), self.random.uniform(0.6, 0.7 * height)
        cameras = shapes.orbit(centre, float(radius), float(eye), angles, 60.0)
        return Scene(
            [*self.walls(width, height, depth), *self.lamps(width, height, depth), *things],
            sky=(float(sky[0]), float(sky[1]), float(sky[2])),
            camera_path=CameraPath.through(cameras),
        )

    def walls(self, width: float, height: float, depth: float) -> list[Instance]:
        """Floor, ceiling, back and sides."""
        w, h, d = width / 2, height, depth / 2
        corners = [
            ((-w, 0, d), (width, 0, 0), (0, 0, -depth)),
            ((-w, h, -d), (width, 0, 0), (0, 0, depth)),
            ((-w, 0, -d), (width, 0, 0), (0, h, 0)),
            ((-w, 0, d), (0, 0, -depth), (0, h, 0)),
            ((w, 0, -d), (0, 0, depth), (0, h, 0)),
        ]
        return [shapes.quad(*corner, painted(self.texture())) for corner in corners]

    def lamps(self, width: float, height: float, depth: float) -> list[Instance]:
        """One to three panels of any size below the ceiling, with about the same total light."""
        count = int(self.random.integers(1, 4))
        return [self.panel(width, height, depth, 12.0 / count) for _ in range(count)]

    def panel(self, width: float, height: float, depth: float, power: float) -> Instance:
        """A lamp that faces down."""
        size = np.exp(self.random.uniform(np.log(0.08), np.log(1.4), 2))
        x, z = self.random.uniform(-0.4, 0.4, 2) * (width, depth)
        radiance = power / (size[0] * size[1]) * self.random.uniform(0.6, 1.0, 3)
        return shapes.quad((x, height - 0.05, z), (size[0], 0, 0), (0, 0, size[1]), lamp(*map(float, radiance)))

    def thing(self, width: float, depth: float) -> Instance:
        """An object that stands on the floor."""
        x, z = self.random.uniform(-0.42, 0.42, 2) * (width, depth)
        size = float(np.exp(self.random.uniform(np.log(0.15), np.log(0.7))))
        kind, material = self.random.integers(5), self.material()
        motion = self.motion() if self.moves and self.random.random() < 0.3 else None
        if kind == 0:
            tall = size * float(self.random.uniform(0.5, 4.0))
            block = shapes.box((size, tall, size * float(self.random.uniform(0.3, 1.5))))
            turn = float(self.random.uniform(0, 90))
            return shapes.place(block, material, (x, tall / 2, z), turn, motion=motion)
        if kind == 1:
            return shapes.ball(size / 2, (x, size / 2, z), material)
        if kind == 2:
            return shapes.ring(size / 2, size / 8, (x, size / 8 + float(self.random.uniform(0, 1)), z), material)
        if kind == 3:
            outline = [(0.0, 0.0), (size / 2, 0.0), (size / 3, size), (size / 5, 1.6 * size), (0.0, 1.7 * size)]
            return shapes.lathe(outline, material, (x, 0.0, z), motion=motion)
        bars = [shapes.rod((x + 0.09 * i, 0, z), (x + 0.09 * i, 3 * size, z), 0.012) for i in range(7)]
        return shapes.merged(bars, material, motion=motion)

    def motion(self) -> Motion:
        """Motion to and fro by up to a metre."""
        x, y, z = self.random.uniform((-1.0, 0.0, -1.0), (1.0, 0.3, 1.0))
        return Motion.sliding((0.0, SECONDS / 2, SECONDS), np.array([(0, 0, 0), (x, y, z), (0, 0, 0)]))

    def material(self) -> Material:
        """A matt, coated or metal material."""
        kind, roughness = self.random.random(), float(self.random.uniform(0.15, 0.6))
        if kind < 0.55:
            return Material(self.colour())
        return metal(self.colour(), roughness) if kind < 0.7 else glazed(self.colour(), roughness)

    def colour(self) -> Colour:
        """Any colour; most are dull."""
        red, green, blue = self.random.uniform(0.1, 0.85) * self.random.uniform(0.5, 1.0, 3)
        return float(red), float(green), float(blue)

    def texture(self) -> Image:
        """A pattern in two tones."""
        dark, light = np.sort(self.random.uniform(50, 220, (2, 1)) + self.random.normal(0, 25, (2, 3)), axis=0)
        seed = int(self.random.integers(1000))
        drawn = (
            lambda: plaster(256, seed, 0.9 * light, light),
            lambda: plaster(256, seed, dark, light),
            lambda: tiles(12, 12, dark, light, 0.8 * dark),
            lambda: bricks(8, 16, dark, light, 0.7 * light),
            lambda: planks(12, dark, light),
            lambda: marble(256, seed, light, dark),
        )
        return drawn[int(self.random.integers(len(drawn)))]()
