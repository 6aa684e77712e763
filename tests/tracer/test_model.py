from __future__ import annotations

import numpy as np

from svgf_cl_tracer.camera import Camera, CameraPath, CarriedCamera
from svgf_cl_tracer.geometry import Instance
from svgf_cl_tracer.lights import PointLight, Sun
from svgf_cl_tracer.materials import Material
from svgf_cl_tracer.model import Eye, Light, Model, Object
from svgf_cl_tracer.motion import Motion

UP, WIDER = Motion.sliding([0, 1], [[0, 0, 0], [0, 2, 0]]), Motion([np.diag([3.0, 1.0, 1.0, 1.0])])
STEEL = Material()


def item(*nodes: str, material: Material = STEEL, motion: Motion | None = None) -> Object:
    return Object(Instance(np.zeros((1, 3, 3)), material, motion=motion), nodes, "steel")


def test_a_motion_carries_what_hangs_on_its_nodes_on_top_of_their_own() -> None:
    lamp = Light(PointLight((1, 0, 0), (1, 1, 1)), ("door", "lamp"))
    sun = Light(Sun((0, 1, 0), (1, 1, 1)), ("door",))
    model = Model([item("door"), item("door", "handle", motion=WIDER), item("floor")], [lamp, sun])
    carried = model.carried(frozenset(["door"]), UP)
    door, handle, floor = (item.instance.motion for item in carried.objects)
    np.testing.assert_allclose(door.matrix(0.5) @ (1, 1, 1, 1), (1, 2, 1, 1))
    np.testing.assert_allclose(handle.matrix(0.5) @ (1, 1, 1, 1), (3, 2, 1, 1))
    assert floor is None
    np.testing.assert_allclose(carried.lights[0].light.placed(0.5)[0], (1, 1, 0))
    np.testing.assert_allclose(carried.lights[1].light.direction_at(0.5), (0, 1, 0))
    turned = model.carried(frozenset(["door"]), Motion.turning((9, 9, 9), (0, 0, 1), [0, 1], [0, 90]))
    np.testing.assert_allclose(turned.lights[1].light.direction_at(1.0), (-1, 0, 0), atol=1e-12)


def test_a_camera_goes_with_what_it_hangs_on() -> None:
    eye = Eye(CarriedCamera(Camera((0, 0, 0), (0, 0, -1)), WIDER), ("car", "eye"))
    model = Model([item("car"), item("street")], eye=eye)
    assert model.nodes == {"car", "eye", "street"}
    assert isinstance(eye.path, CameraPath)  # nothing moves it
    assert model.carried(frozenset(["street"]), UP).eye is eye
    carried = model.carried(frozenset(["car"]), UP).eye.path
    assert isinstance(carried, CarriedCamera)
    assert carried.at_time(0.5).position == (0, 1, 0)


def test_objects_of_one_material_still_share_it_when_painted() -> None:
    wood = Material()
    seen = []
    model = Model([item("a"), item("b"), item("c", material=wood)])
    painted = model.painted(lambda name, material: seen.append(name) or Material(emission=(1, 0, 0)))
    first, second, third = (item.instance.material for item in painted.objects)
    assert first is second
    assert first is not third
    assert seen == ["steel", "steel"]
