"""The scene: what is in it, and what that makes at a moment, ready to be traced."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from .boxes import EVERYWHERE, bounds
from .camera import Camera, CameraPath, vector
from .errors import SceneError
from .geometry import Instance, Triangles, corners_of
from .light_sampling import Lights
from .lights import PointLight, Sun
from .materials import Colour, Materials
from .sky import Environment, SkyTable, sky_table
from .trees import Tree, Trees
from .vectors import Float32, Float64


class Tables(NamedTuple):
    """Everything about a scene at one moment that compiled loops look up."""

    triangles: Triangles
    materials: Materials
    lights: Lights
    sky: SkyTable


class Moment(NamedTuple):
    """A scene at one time.

    `goals` are boxes (2, 3): paths that may not be scattered any more bring no light unless they pass one of them.
    """

    tables: Tables
    trees: Trees
    goals: tuple[Float64, ...]


class Scene:
    """Objects, lights, a sky and a default camera path.

    Parameters
    ----------
    instances : sequence of Instance
        The objects; their ids in images count from 1 in this order.
    lights : sequence of Sun or PointLight, optional
        Lights that are no triangles.
    sky : (r, g, b) or Environment, optional
        Radiance that comes from everywhere outside the scene, linear, >= 0; none where absent.
    camera_path : CameraPath, optional
        The default view; a still camera that frames everything where absent.

    Raises
    ------
    SceneError
        There is no triangle, a coordinate is not finite, or nothing emits light.
    """

    def __init__(
        self,
        instances: Sequence[Instance],
        *,
        lights: Sequence[Sun | PointLight] = (),
        sky: Colour | Environment | None = None,
        camera_path: CameraPath | None = None,
    ) -> None:
        self.instances = tuple(instance for instance in instances if len(instance.corners))
        self.lights, self.sky = tuple(lights), sky
        _check(self.instances)
        constant = None if isinstance(sky, Environment) else sky
        if constant is not None and not (np.isfinite(constant).all() and min(constant) >= 0.0):
            raise SceneError(f"sky: expected three radiances >= 0, got {sky}")
        self.camera_path = camera_path or CameraPath.static(_framing(self.instances))
        self._prepare()
        if not self._shines():
            raise SceneError("scene: nothing in it emits light; give it a sky, for example --sky 1,1,1")

    def __reduce__(self) -> tuple[object, ...]:
        """Pickled as what it is made of: Embree's trees cannot be sent to another process."""
        return _make, (self.instances, self.lights, self.sky, self.camera_path)

    def at(self, time: float) -> Moment:
        """The scene at `time` in seconds."""
        if self._still is not None:
            return self._still
        triangles = self._triangles.moved(self._moving, time) if self._moving else self._triangles
        trees = [*self._trees, *self._grow(self._moving, triangles, self.first_moving)]
        materials = self._materials._replace(
            emission=np.array([np.multiply(m.emission, m.brightness_at(time)) for m in self._kinds])
        )
        lights = Lights.of(triangles, self._kinds, self.lights, self._sky, time)
        tables = Tables(triangles, materials, lights, self._sky)
        return Moment(tables, Trees(trees, triangles, materials), self._goals(time))

    def corners_at(self, time: float) -> Float32:
        """First corner and edges (M, 3, 3) of the triangles that move, from `first_moving` on, at `time` in seconds."""
        return corners_of(self._moving, time)

    @property
    def changes(self) -> bool:
        """Whether anything but the camera moves or changes."""
        return self._still is None

    def _prepare(self) -> None:
        """Gather all that never changes."""
        self._kinds = list({id(i.material): i.material for i in self.instances}.values())
        kind = {id(material): number for number, material in enumerate(self._kinds)}
        # Neighbours in the table share a tree: what stands still before what moves, the solid before the masked.
        ordered = sorted(enumerate(self.instances, 1), key=lambda each: (each[1].motion is not None, each[1].masked))
        ids, instances = zip(*ordered, strict=True)
        still = [instance for instance in instances if instance.motion is None]
        self._moving = [instance for instance in instances if instance.motion is not None]
        self._materials = Materials.of(self._kinds)
        self._sky = sky_table(self.sky)
        self.first_moving = sum(len(instance.corners) for instance in still)
        self._triangles = Triangles.of(instances, ids, [kind[id(instance.material)] for instance in instances], 0.0)
        self._trees = self._grow(still, self._triangles, 0)
        self._still: Moment | None = None
        lights_change = any(isinstance(light, PointLight) and light.motion is not None for light in self.lights)
        if not (self._moving or lights_change or any(m.brightness is not None for m in self._kinds)):
            lights = Lights.of(self._triangles, self._kinds, self.lights, self._sky, 0.0)
            tables = Tables(self._triangles, self._materials, lights, self._sky)
            self._still = Moment(tables, Trees(self._trees, self._triangles, self._materials), self._goals(0.0))

    def _grow(self, instances: Sequence[Instance], triangles: Triangles, first: int) -> list[Tree]:
        """The trees over `instances`, whose triangles begin at `first` in the table: solid ones, masked ones."""
        trees = []
        for masked in (False, True):
            count = sum(len(instance.corners) for instance in instances if instance.masked == masked)
            if count:
                trees.append(Tree(triangles.corners[first : first + count], first, masked=masked))
            first += count
        return trees

    def _goals(self, time: float) -> tuple[Float64, ...]:
        """A box for each material that shines or lets light through; everywhere, where light comes from outside."""
        if self._shines_outside():
            return (EVERYWHERE,)
        boxes: dict[int, list[Float64]] = {}
        for instance in self.instances:
            if instance.material.transmissive or max(instance.material.emission) > 0.0:
                boxes.setdefault(id(instance.material), []).append(instance.box_at(time))
        return tuple(bounds(np.array(each)) for each in boxes.values())

    def _shines(self) -> bool:
        points = [light.intensity for light in self.lights if isinstance(light, PointLight)]
        lamps = [instance.material.emission for instance in self.instances]
        return self._shines_outside() or any(max(light) > 0.0 for light in (*points, *lamps))

    def _shines_outside(self) -> bool:
        sky = self.sky.image if isinstance(self.sky, Environment) else self.sky
        suns = [light.irradiance for light in self.lights if isinstance(light, Sun)]
        return bool(sky is not None and np.max(sky) > 0.0) or any(max(sun) > 0.0 for sun in suns)


def _make(
    instances: Sequence[Instance],
    lights: Sequence[Sun | PointLight],
    sky: Colour | Environment | None,
    camera_path: CameraPath,
) -> Scene:
    return Scene(instances, lights=lights, sky=sky, camera_path=camera_path)


def _check(instances: Sequence[Instance]) -> None:
    if not instances:
        raise SceneError("scene: expected at least one triangle, got none")
    if not all(np.isfinite(instance.corners).all() for instance in instances):
        raise SceneError("scene: expected finite vertex positions, got NaN or infinity")
    if not all(instance.uv is None or np.isfinite(instance.uv).all() for instance in instances):
        raise SceneError("scene: expected finite texture coordinates, got NaN or infinity")
    if not all(instance.colours is None or np.isfinite(instance.colours).all() for instance in instances):
        raise SceneError("scene: expected finite vertex colours, got NaN or infinity")


def _framing(instances: Sequence[Instance]) -> Camera:
    """A camera that sees the bounding sphere of everything, from the front, a little above."""
    corners = [instance.corners_at(0.0) for instance in instances]
    low = np.min([part.min((0, 1)) for part in corners], axis=0)
    high = np.max([part.max((0, 1)) for part in corners], axis=0)
    middle, radius = (low + high) / 2.0, np.linalg.norm(high - low) / 2.0
    towards = np.array([0.35, 0.3, 1.0]) / np.linalg.norm([0.35, 0.3, 1.0])
    eye = middle + towards * max(radius, 1e-6) / np.sin(np.radians(Camera.fov_y / 2.0))
    return Camera(vector(eye), vector(middle))
