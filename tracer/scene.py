"""The scene: geometry, materials, lights and sky, ready to be traced."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .camera import Camera, CameraPath, vector
from .errors import SceneError
from .geometry import Instance, Triangles
from .lights import AreaLights, PointLight, Sun
from .materials import Colour, Material, MaterialTable
from .sky import Environment
from .vectors import Float32


class Scene:
    """Objects, a sky and a default camera path.

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
        instances = [instance for instance in instances if len(instance.corners)]
        if not instances:
            raise SceneError("scene: expected at least one triangle, got none")
        if not all(np.isfinite(instance.corners).all() for instance in instances):
            raise SceneError("scene: expected finite vertex positions, got NaN or infinity")
        if sky is not None and not (np.isfinite(sky).all() and min(sky) >= 0.0):
            raise SceneError(f"sky: expected three radiances >= 0, got {sky}")
        materials: dict[int, Material] = {id(i.material): i.material for i in instances}
        number = {key: index for index, key in enumerate(materials)}
        self.triangles = Triangles(instances, [number[id(i.material)] for i in instances])
        self.materials = MaterialTable(list(materials.values()))
        self.lights = AreaLights(self.triangles, list(materials.values()), self.materials)
        self.sky: Float32 | None = np.array(sky, np.float32)[:, None] if sky is not None and max(sky) > 0.0 else None
        if self.sky is None and not self.lights.count:
            raise SceneError("scene: nothing in it emits light; give it a sky, for example --sky 1,1,1")
        self.camera_path = camera_path or CameraPath.static(_framing(instances))


def _framing(instances: Sequence[Instance]) -> Camera:
    """A camera that sees the bounding sphere of everything, from the front, a little above."""
    low = np.min([instance.corners.min((0, 1)) for instance in instances], axis=0)
    high = np.max([instance.corners.max((0, 1)) for instance in instances], axis=0)
    middle, radius = (low + high) / 2.0, np.linalg.norm(high - low) / 2.0
    towards = np.array([0.35, 0.3, 1.0]) / np.linalg.norm([0.35, 0.3, 1.0])
    eye = middle + towards * max(radius, 1e-6) / np.sin(np.radians(Camera.fov_y / 2.0))
    return Camera(vector(eye), vector(middle))
