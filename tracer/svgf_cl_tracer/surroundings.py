"""The tables and trees of a scene at a moment, with positions relative to an origin, ready for tracing.

Rays and triangles are in single precision, which is finer near 0. So the origin is near the visible part of the scene,
and all positions are moved there first, in double precision. This happens here and nowhere else.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from .boxes import EVERYWHERE, bounds
from .geometry import Instance, Triangles, corners_of
from .light_sampling import Lights
from .materials import Materials
from .sky import SkyTable
from .trees import Tree, Trees
from .vec3 import Vec3
from .vectors import Float32, Float64

if TYPE_CHECKING:
    from .scene import Scene


class Tables(NamedTuple):
    """All tables of a scene at one moment that compiled loops read."""

    triangles: Triangles
    materials: Materials
    lights: Lights
    sky: SkyTable


class Moment(NamedTuple):
    """A scene at one time.

    `goals` are boxes (2, 3): a path that can no longer be scattered brings no light unless it passes one of them.
    """

    tables: Tables
    trees: Trees
    goals: tuple[Float64, ...]


class Surroundings:
    """A scene around an origin: trees of everything that does not move, and the data for any moment.

    Parameters
    ----------
    scene : Scene
    origin : (x, y, z)
        In the scene's own coordinates.
    """

    def __init__(self, scene: Scene, origin: Vec3) -> None:
        self.origin = origin
        # Neighbours in the table share a tree: still objects come before moving ones, and solid before masked ones.
        ordered = sorted(enumerate(scene.instances, 1), key=lambda each: (each[1].motion is not None, each[1].masked))
        instances = [instance.relative_to(origin) for _, instance in ordered]
        still = [instance for instance in instances if instance.motion is None]
        self._moving = [instance for instance in instances if instance.motion is not None]
        self._lights = [light.relative_to(origin) for light in scene.lights]
        self._materials, self._looks, self._sky = scene.materials, scene.looks, scene.sky_table
        self._goals = None if scene.shines_outside() else [instance for instance in instances if _is_goal(instance)]
        self.first_moving = sum(len(instance.corners) for instance in still)
        numbers = {id(material): number for number, material in enumerate(scene.materials)}
        materials = [numbers[id(instance.material)] for instance in instances]
        self._triangles = Triangles.of(instances, [number for number, _ in ordered], materials, 0.0)
        self._trees = _grow(still, self._triangles, 0)
        self._always = None if scene.changes else self._moment(0.0)

    def at(self, time: float) -> Moment:
        """The scene at `time` in seconds."""
        return self._always or self._moment(time)

    def corners_at(self, time: float) -> Float32:
        """First corner and edges (M, 3, 3) of the moving triangles, from `first_moving` on, at `time` in seconds."""
        return corners_of(self._moving, time)

    def _moment(self, time: float) -> Moment:
        triangles = self._triangles.moved(self._moving, time) if self._moving else self._triangles
        trees = [*self._trees, *_grow(self._moving, triangles, self.first_moving)]
        emission = np.array([np.multiply(m.emission, m.brightness_at(time)) for m in self._materials])
        looks = self._looks._replace(emission=emission)
        lights = Lights.of(triangles, self._materials, self._lights, self._sky, time)
        return Moment(Tables(triangles, looks, lights, self._sky), Trees(trees, triangles, looks), self._boxes(time))

    def _boxes(self, time: float) -> tuple[Float64, ...]:
        """A box for each material that emits or transmits light; everything, if light arrives from outside."""
        if self._goals is None:
            return (EVERYWHERE,)
        boxes: dict[int, list[Float64]] = {}
        for instance in self._goals:
            boxes.setdefault(id(instance.material), []).append(instance.box_at(time))
        return tuple(bounds(np.array(each)) for each in boxes.values())


def _is_goal(instance: Instance) -> bool:
    return instance.material.transmissive or max(instance.material.emission) > 0.0


def _grow(instances: Sequence[Instance], triangles: Triangles, first: int) -> list[Tree]:
    """The trees of solid and of masked triangles of `instances`, which begin at `first` in the table."""
    trees = []
    for masked in (False, True):
        count = sum(len(instance.corners) for instance in instances if instance.masked == masked)
        if count:
            trees.append(Tree(triangles.corners[first : first + count], first, masked=masked))
        first += count
    return trees
