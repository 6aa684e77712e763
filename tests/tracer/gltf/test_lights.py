from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from svgf_cl_tracer import SceneError
from svgf_cl_tracer.gltf.file import Gltf
from svgf_cl_tracer.gltf.lights import read_camera, read_lights
from svgf_cl_tracer.gltf.nodes import Nodes
from svgf_cl_tracer.lights import PointLight, Sun
from tests.tracer.gltf_files import Buffers, write_gltf

# A quarter turn about x: -z becomes +y, -y.
UP, DOWN = (np.sqrt(0.5), 0, 0, np.sqrt(0.5)), (-np.sqrt(0.5), 0, 0, np.sqrt(0.5))


def read(
    folder: Path, light: dict[str, Any], node: dict[str, Any], buffers: Buffers | None = None, **more: Any
) -> PointLight | Sun:
    extensions = {"KHR_lights_punctual": {"lights": [{"type": "point"}, light]}}
    nodes = [
        {"name": "pole", "children": [1]},
        {"extensions": {"KHR_lights_punctual": {"light": 1}}, "name": "lamp"} | node,
    ]
    gltf = Gltf.read(write_gltf(folder / "a.gltf", buffers, extensions=extensions, nodes=nodes, **more))
    (found,) = read_lights(gltf, Nodes(gltf, np.eye(4)))
    assert found.nodes == ("pole", "lamp")
    return found.light


def test_a_point_light_is_where_its_node_is(tmp_path: Path) -> None:
    light = read(
        tmp_path, {"type": "point", "color": [1, 0.5, 0.25], "intensity": 40, "range": 9}, {"translation": [1, 2, 3]}
    )
    assert (light.position, light.motion) == ((1, 2, 3), None)
    assert (light.intensity, light.reach) == ((40, 20, 10), 9)
    assert (light.inner_angle, light.outer_angle) == (180, 180)


def test_a_spot_shines_along_minus_z(tmp_path: Path) -> None:
    light = read(tmp_path, {"type": "spot", "spot": {"innerConeAngle": 0.1}}, {"rotation": DOWN})
    np.testing.assert_allclose(light.direction, (0, -1, 0), atol=1e-12)
    assert light.inner_angle == pytest.approx(np.degrees(0.1))
    assert light.outer_angle == pytest.approx(45)


def test_a_light_moves_with_its_node(tmp_path: Path) -> None:
    buffers = Buffers()
    sampler = {"input": buffers.add([0, 1]), "output": buffers.add([[0, 0, 0], [0, 4, 0]])}
    animation = {"samplers": [sampler], "channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}]}
    meshes = [{"primitives": [buffers.square()]}]
    light = read(tmp_path, {"type": "spot"}, {"rotation": UP}, buffers, animations=[animation], meshes=meshes)
    position, direction = light.placed(0.5)
    np.testing.assert_allclose(position, (0, 2, 0), atol=1e-6)
    np.testing.assert_allclose(direction, (0, 1, 0), atol=1e-6)


def test_a_directional_light_turns_with_its_node(tmp_path: Path) -> None:
    """Whatever size the node has, be it none."""
    buffers = Buffers()
    times = buffers.add([0, 1])
    samplers = [{"input": times, "output": buffers.add([UP, DOWN])}]
    samplers.append({"input": times, "output": buffers.add([[0, 0, 0], [2, 2, 2]])})
    paths = ("rotation", "scale")
    channels = [{"sampler": n, "target": {"node": 1, "path": path}} for n, path in enumerate(paths)]
    animation = {"samplers": samplers, "channels": channels}
    meshes = [{"primitives": [buffers.square()]}]
    sun = read(tmp_path, {"type": "directional"}, {}, buffers, animations=[animation], meshes=meshes)
    for time, expected in ((0.0, (0, -1, 0)), (0.5, (0, 0, 1)), (1.0, (0, 1, 0))):
        np.testing.assert_allclose(sun.direction_at(time), expected, atol=1e-6)


def test_a_directional_light_comes_from_plus_z_without_extent(tmp_path: Path) -> None:
    sun = read(tmp_path, {"type": "directional", "intensity": 5}, {"rotation": DOWN, "scale": [3, 3, 3]})
    np.testing.assert_allclose(sun.direction_to_light, (0, 1, 0), atol=1e-12)
    assert (sun.irradiance, sun.angular_radius) == ((5, 5, 5), 0)


@pytest.mark.parametrize(
    ("number", "seen"), [(0, {"view_height": 4}), (1, {"view_height": 0, "fov_y": np.degrees(0.5)})]
)
def test_a_camera_looks_along_minus_z_from_its_node(number: int, seen: dict[str, float], tmp_path: Path) -> None:
    cameras = [
        {"type": "orthographic", "orthographic": {"xmag": 3, "ymag": 2, "znear": 0.1, "zfar": 9}},
        {"type": "perspective", "perspective": {"yfov": 0.5, "znear": 0.1}},
    ]
    nodes = [
        {},
        {"children": [2], "translation": [1, 0, 0]},
        {"camera": number, "translation": [0, 2, 3], "rotation": UP},
    ]
    gltf = Gltf.read(write_gltf(tmp_path / "a.gltf", nodes=nodes, cameras=cameras))
    camera = read_camera(gltf, Nodes(gltf, np.eye(4))).path.at(0.0)
    np.testing.assert_allclose(camera.position, (1, 2, 3))
    np.testing.assert_allclose(camera.basis(), [(1, 0, 0), (0, 0, 1), (0, 1, 0)], atol=1e-9)
    assert {name: getattr(camera, name) for name in seen} == pytest.approx(seen)


def test_a_light_of_another_type_is_refused(tmp_path: Path) -> None:
    with pytest.raises(SceneError, match="lights: expected the type directional, point or spot, found 'ambient'"):
        read(tmp_path, {"type": "ambient"}, {})


def test_a_file_without_a_camera_has_none(tmp_path: Path) -> None:
    gltf = Gltf.read(write_gltf(tmp_path / "a.gltf", Buffers()))
    assert read_camera(gltf, Nodes(gltf, np.eye(4))) is None
