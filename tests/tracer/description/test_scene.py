from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO as oiio  # noqa: N813
import pytest

from svgf_cl_tracer import Environment, Scene, SceneError
from svgf_cl_tracer.description import described_scene
from svgf_cl_tracer.lights import Sun
from tests.tracer.gltf_files import CORNERS, Buffers, write_gltf

Describe = Callable[..., Scene]

SKY = {"type": "sky_constant", "radiance": [1, 2, 3]}
SUN = {"type": "sun", "direction_to_light": [0, 1, 0], "irradiance": [1, 1, 1]}
RECTANGLE = {"type": "rect", "corner": [0, 0, 0], "edge_u": [1, 0, 0], "edge_v": [0, 1, 0], "radiance": [1, 1, 1]}
LAMP = {"type": "area", "material": "lamp", "radiance": [7, 8, 9]}


@pytest.fixture
def describe(tmp_path: Path) -> Describe:
    """Maker of the scene that fields of a scene.json make of a model: a post with a lamp, beside a wall."""
    nodes = [{"name": "post", "mesh": 0, "children": [1]}, {"name": "lamp", "mesh": 1}, {"name": "wall", "mesh": 0}]
    buffers = Buffers()
    meshes = [{"primitives": [buffers.square(0)]}, {"primitives": [buffers.square(1)]}]
    materials = [{"name": "wood"}, {"name": "lamp", "emissiveFactor": [1, 1, 1]}]
    write_gltf(tmp_path / "a.gltf", buffers, nodes=nodes, meshes=meshes, materials=materials)

    def make(arguments: dict[str, Any] | None = None, **fields: Any) -> Scene:
        (tmp_path / "scene.json").write_text(json.dumps({"model": "a.gltf"} | fields))
        return described_scene(tmp_path, **(arguments or {}))

    return make


def emissions(scene: Scene) -> list[tuple[float, float, float]]:
    return [instance.material.emission for instance in scene.instances]


def test_what_is_not_described_is_the_models(describe: Describe) -> None:
    scene = describe()
    assert emissions(scene) == [(0, 0, 0), (1, 1, 1), (0, 0, 0)]
    assert (scene.lights, scene.sky) == ((), None)
    assert all(instance.motion is None for instance in scene.instances)


def test_lights_of_every_kind(describe: Describe) -> None:
    scene = describe(lights=[SKY, SUN, RECTANGLE, LAMP])
    assert scene.sky == (1, 2, 3)
    assert [type(light) for light in scene.lights] == [Sun]
    assert emissions(scene) == [(0, 0, 0), (7, 8, 9), (0, 0, 0), (1, 1, 1)]


def test_a_material_that_is_described_shines_only_as_an_area_light(describe: Describe) -> None:
    dark = {"lamp": {"type": "diffuse", "radiance": [7, 8, 9]}}
    assert emissions(describe(materials=dark, lights=[SUN]))[1] == (0, 0, 0)
    assert emissions(describe(materials=dark, lights=[LAMP]))[1] == (7, 8, 9)


def test_alternative_lights_are_in_place_of_the_others(describe: Describe) -> None:
    scene = describe({"alternative_lights": True}, lights=[SKY, LAMP], alternative_lights=[SUN])
    assert scene.sky is None
    assert len(scene.lights) == 1
    assert emissions(scene)[1] == (1, 1, 1)


def test_a_sky_from_outside_is_in_place_of_the_scenes(describe: Describe) -> None:
    scene = describe({"sky": (4.0, 5.0, 6.0)}, lights=[SKY, SUN])
    assert scene.sky == (4, 5, 6)
    assert len(scene.lights) == 1


def test_an_environment_map_is_turned_into_the_world(describe: Describe, tmp_path: Path) -> None:
    spec = oiio.ImageSpec(4, 2, 3, "float")
    image = oiio.ImageBuf(spec)
    image.set_pixels(spec.roi, np.ones((2, 4, 3), np.float32))
    image.write(str(tmp_path / "sky.exr"))
    rows = [[0, 0, 1], [0, 1, 0], [-1, 0, 0]]
    sky = describe(lights=[{"type": "envmap", "file": "sky.exr", "to_world_rows": rows}]).sky
    assert isinstance(sky, Environment)
    np.testing.assert_array_equal(sky.to_world @ (0, 0, -1), (-1, 0, 0))


def test_cameras_make_a_path(describe: Describe) -> None:
    cameras = [{"position": [x, 0, 2], "look_at": [x, 0, 0], "aperture": 0.1, "shutter": 0.5} for x in (0, 1)]
    path = describe(lights=[SKY], camera=cameras).camera_path
    assert path.at(0.5).position == (0.5, 0, 2)
    assert (path.at(0.5).aperture, path.at(0.5).shutter) == (pytest.approx(0.1), pytest.approx(0.5))


def test_an_animation_carries_its_nodes_and_what_hangs_on_them(describe: Describe) -> None:
    slide = {"kind": "keyframes", "nodes": ["post"], "times_s": [0, 1], "translation": [[0, 0, 0], [2, 0, 0]]}
    turn = {"kind": "rigid rotation about +Y", "nodes": ["lamp"], "angle_deg": [0, 90]}
    post, lamp, wall = describe(lights=[SKY], animation=[slide, turn]).instances
    np.testing.assert_allclose(post.motion.matrix(1.0) @ (1, 0, 0, 1), (3, 0, 0, 1))
    np.testing.assert_allclose(lamp.motion.matrix(1.0) @ (1, 0, 0, 1), (0, 0, -3, 1), atol=1e-12)
    assert wall.motion is None


def test_the_models_frame_is_turned_upright_and_scaled(describe: Describe) -> None:
    wall = describe(lights=[SKY], up_axis="z", metres_per_unit=10).instances[2]
    np.testing.assert_allclose(wall.corners[0], 10 * CORNERS[:3][:, [0, 2, 1]] * (1, 1, -1))


@pytest.mark.parametrize(
    ("fields", "complaint"),
    [
        (
            {"materials": {"steel": {"type": "diffuse"}}},
            r"materials: expected names of the model \(lamp, wood\), found 'steel'",
        ),
        ({"lights": [LAMP | {"material": "x"}]}, r"lights: material: expected names of the model .* found 'x'"),
        (
            {"materials": {"wood": {"type": "diffuse", "base_texture": True}}},
            r"materials\.wood: base_texture: expected",
        ),
        (
            {"animation": {"kind": "rigid rotation about +Y", "nodes": ["door"], "angle_deg": [0]}},
            r"animation: nodes: expected names of the model \(lamp, post, wall\), found 'door'",
        ),
        ({"model": "../elsewhere.glb"}, "expected a file inside the scene's folder, found '../elsewhere.glb'"),
        ({"model": "/etc/hostname"}, "expected a file inside the scene's folder"),
        ({"model": "b.glb"}, r"b\.glb: no such file"),
        ({"lights": [{"type": "envmap", "file": "../sky.hdr"}]}, "expected a file inside the scene's folder"),
        ({"materials": {"lamp": {"type": "diffuse"}}}, "nothing in it emits light; give it a sky, for example --sky"),
        ({"camera": {"position": [0, 0, 0], "look_at": [0, 1, 0]}}, "camera: expected a point to look at"),
    ],
)
def test_what_does_not_fit_is_named(describe: Describe, fields: dict[str, Any], complaint: str) -> None:
    with pytest.raises(SceneError, match=rf"scene\.json: .*{complaint}"):
        describe(**fields)


def test_alternative_lights_that_are_not_there(describe: Describe) -> None:
    with pytest.raises(SceneError, match="alternative_lights: expected at least one light, found none"):
        describe({"alternative_lights": True})
