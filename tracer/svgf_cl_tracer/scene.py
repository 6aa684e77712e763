"""The scene: objects, lights, sky and camera path."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np

from .boxes import bounds
from .camera import Camera, CameraPath, CarriedCamera, vector
from .errors import SceneError
from .geometry import Instance
from .lights import PointLight, Sun
from .materials import Colour, Materials
from .sky import Environment, sky_table
from .surroundings import Surroundings
from .vec3 import Vec3
from .vectors import Float64

# The number of moments at which a moving object's position is checked, so that the camera can see all of them.
MOMENTS = 17


class Scene:
    """Objects, lights, a sky and a default camera path.

    Parameters
    ----------
    instances : sequence of Instance
        The objects; their ids in images count from 1 in this order.
    lights : sequence of Sun or PointLight, optional
        Lights without triangles.
    sky : (r, g, b) or Environment, optional
        Radiance that arrives from all directions outside the scene, linear, >= 0; by default none.
    camera_path : CameraPath or CarriedCamera, optional
        The default view; by default, a still camera that shows the whole scene.

    Raises
    ------
    SceneError
        If there is no triangle, if a coordinate is not finite, or if nothing emits light.
    """

    def __init__(
        self,
        instances: Sequence[Instance],
        *,
        lights: Sequence[Sun | PointLight] = (),
        sky: Colour | Environment | None = None,
        camera_path: CameraPath | CarriedCamera | None = None,
    ) -> None:
        self.instances = tuple(instance for instance in instances if len(instance.corners))
        self.lights, self.sky = tuple(lights), sky
        _check(self.instances)
        constant = None if isinstance(sky, Environment) else sky
        if constant is not None and not (np.isfinite(constant).all() and min(constant) >= 0.0):
            raise SceneError(f"sky: expected three radiances >= 0, got {sky}")
        self.camera_path = camera_path or CameraPath.static(_framing(self.instances))
        if not self._shines():
            raise SceneError("scene: nothing in it emits light; give it a sky, for example --sky 1,1,1")
        self.materials = list({id(instance.material): instance.material for instance in self.instances}.values())
        self.looks, self.sky_table = Materials.of(self.materials), sky_table(sky)
        self._latest: Surroundings | None = None

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle the scene's content only, because Embree's trees cannot be sent to another process."""
        return _make, (self.instances, self.lights, self.sky, self.camera_path)

    def around(self, origin: Vec3) -> Surroundings:
        """The scene with positions relative to `origin`; the result for the last origin is kept."""
        latest = self._latest
        if latest is None or latest.origin != origin:
            self._latest = latest = Surroundings(self, origin)
        return latest

    def nearest(self, point: Vec3, time: float) -> Float64:
        """The point (3,) of the box around everything at `time` in seconds that is nearest to `point`."""
        low, high = self._box_at(time)
        return np.clip(point, low, high)

    @cached_property
    def detail(self) -> float:
        """The size of details, of moving objects in their own space: the median of all triangles' shortest edges."""
        corners = [instance.corners for instance in self.instances]
        edges = [np.linalg.norm(part - np.roll(part, 1, axis=1), axis=-1).min(1) for part in corners]
        return float(np.median(np.concatenate(edges)))

    @cached_property
    def changes(self) -> bool:
        """Whether anything but the camera moves or changes."""
        moves = any(thing.motion is not None for thing in (*self.instances, *self.lights))
        return moves or any(material.brightness is not None for material in self.materials)

    def shines_outside(self) -> bool:
        """Whether light arrives from outside, from the sky or a sun."""
        sky = self.sky.image if isinstance(self.sky, Environment) else self.sky
        suns = [light.irradiance for light in self.lights if isinstance(light, Sun)]
        return bool(sky is not None and np.max(sky) > 0.0) or any(max(sun) > 0.0 for sun in suns)

    def _box_at(self, time: float) -> Float64:
        return bounds(np.array([instance.box_at(time) for instance in self.instances]))

    def _shines(self) -> bool:
        points = [light.intensity for light in self.lights if isinstance(light, PointLight)]
        lamps = [instance.material.emission for instance in self.instances]
        return self.shines_outside() or any(max(light) > 0.0 for light in (*points, *lamps))


def _make(
    instances: Sequence[Instance],
    lights: Sequence[Sun | PointLight],
    sky: Colour | Environment | None,
    camera_path: CameraPath | CarriedCamera,
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
    """A camera that sees the bounding sphere of the scene, including all motion, from the front and a little above."""
    boxes = np.array([instance.box_at(time) for instance in instances for time in _moments(instance)])
    low, high = bounds(boxes)
    middle, radius = (low + high) / 2.0, np.linalg.norm(high - low) / 2.0
    # A scene of a single point is viewed from a distance that double precision can represent.
    distance = max(radius, 1e-9 * np.abs(middle).max()) or 1.0
    towards = np.array([0.35, 0.3, 1.0]) / np.linalg.norm([0.35, 0.3, 1.0])
    eye = middle + towards * distance / np.sin(np.radians(Camera.fov_y / 2.0))
    return Camera(vector(eye), vector(middle))


def _moments(instance: Instance) -> Float64:
    """Times in seconds, from 0 on, that show where it moves."""
    first, last = (0.0, 0.0) if instance.motion is None else instance.motion.span
    return np.unique(np.maximum(np.linspace(first, last, MOMENTS), 0.0))
