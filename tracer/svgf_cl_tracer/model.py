"""The content of a model file, before a description adds materials and lights."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import TypeVar

from .camera import CameraPath, CarriedCamera
from .geometry import Instance
from .lights import PointLight, Sun
from .materials import Material
from .motion import Motion

Thing = TypeVar("Thing", "Object", "Light", "Eye")


@dataclass(frozen=True, eq=False)
class Object:
    """An instance, and its names in the file.

    Parameters
    ----------
    instance : Instance
    nodes : tuple of str
        The names of the nodes above its node, outermost first, and the name of its node.
    material : str
    """

    instance: Instance
    nodes: tuple[str, ...]
    material: str

    def carried(self, motion: Motion) -> Object:
        """The object with `motion` applied after its own."""
        return replace(self, instance=replace(self.instance, motion=_on_top(motion, self.instance.motion)))


@dataclass(frozen=True, eq=False)
class Light:
    """A light, and the names of its node and of the nodes above it, outermost first."""

    light: PointLight | Sun
    nodes: tuple[str, ...]

    def carried(self, motion: Motion) -> Light:
        """The light with `motion` applied after its own."""
        return replace(self, light=replace(self.light, motion=_on_top(motion, self.light.motion)))


@dataclass(frozen=True, eq=False)
class Eye:
    """A camera, and the names of its node and of the nodes above it, outermost first."""

    camera: CarriedCamera
    nodes: tuple[str, ...]

    @property
    def path(self) -> CameraPath | CarriedCamera:
        """The camera's path."""
        return self.camera if self.camera.motion.changes else CameraPath.static(self.camera.at_time(0.0))

    def carried(self, motion: Motion) -> Eye:
        """The camera with `motion` applied after its own."""
        return replace(self, camera=replace(self.camera, motion=_on_top(motion, self.camera.motion)))


@dataclass(frozen=True, eq=False)
class Model:
    """The objects, lights and camera of a file."""

    objects: list[Object]
    lights: list[Light] = field(default_factory=list)
    eye: Eye | None = None

    @property
    def nodes(self) -> set[str]:
        """The names of all nodes that carry an object, light or camera, directly or below them."""
        things = [item.nodes for item in self.objects] + [item.nodes for item in self.lights]
        return {name for names in (*things, self.eye.nodes if self.eye else ()) for name in names}

    def carried(self, nodes: frozenset[str], motion: Motion) -> Model:
        """The model, with `motion` applied to those nodes and everything below them."""

        def carry(item: Thing) -> Thing:
            return item.carried(motion) if nodes.intersection(item.nodes) else item

        eye = None if self.eye is None else carry(self.eye)
        return replace(self, objects=[*map(carry, self.objects)], lights=[*map(carry, self.lights)], eye=eye)

    def painted(self, paint: Callable[[str, Material], Material]) -> Model:
        """The model with other materials, which `paint` makes from the name and the material of each."""
        made: dict[int, Material] = {}
        objects = []
        for item in self.objects:
            material = item.instance.material
            if id(material) not in made:
                made[id(material)] = paint(item.material, material)
            objects.append(replace(item, instance=replace(item.instance, material=made[id(material)])))
        return replace(self, objects=objects)


def _on_top(outer: Motion, inner: Motion | None) -> Motion:
    return Motion([*outer.links, *(inner.links if inner else ())])
