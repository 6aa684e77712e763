from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from svgf_cl_tracer import Camera, CameraPath, Scene, SceneError, Shot, load_scene, render_frame
from svgf_cl_tracer.textures import LINEAR
from tests.tracer.gltf_files import Buffers, png, uri, write_gltf

SKY = (1.0, 1.0, 1.0)
# Red and green above blue and white; the green is a hole where alpha counts.
IMAGE = np.array([[(255, 0, 0, 255), (0, 255, 0, 0)], [(0, 0, 255, 255), (255, 255, 255, 255)]], np.uint8)
TEXTURE = {"baseColorTexture": {"index": 0}, "metallicFactor": 0}
PICTURE = {"textures": [{"source": 0}], "images": [{"uri": uri(png(IMAGE.repeat(16, 0).repeat(16, 1)), "image/png")}]}
# Sees the unit square around the origin, and a little more.
FRONT = CameraPath.static(Camera((0, 0, 2), (0, 0, 0), fov_y=30.0))


def quarters(scene: Scene, field: str = "albedo") -> np.ndarray:
    """A field (2, 2, ...) in the middle of each quarter of the square as seen from the front."""
    frame = render_frame(Shot(scene, (40, 40), camera_path=FRONT), 0, jitter=False)
    return np.asarray(getattr(frame, field)[10:31:20, 10:31:20])


def test_gltf_textures_stand_upright(tmp_path: Path) -> None:
    base = TEXTURE | {"baseColorFactor": [0.5, 1, 0.25, 1]}
    matt = {"KHR_materials_specular": {"specularFactor": 0}}
    path = write_gltf(tmp_path / "a.gltf", materials=[{"pbrMetallicRoughness": base, "extensions": matt}], **PICTURE)
    np.testing.assert_allclose(quarters(load_scene(path, SKY)), LINEAR[IMAGE[..., :3]] * (0.5, 1, 0.25), atol=1e-6)


def test_one_sees_through_holes(tmp_path: Path) -> None:
    foil = {"pbrMetallicRoughness": TEXTURE, "alphaMode": "MASK"}
    path = write_gltf(tmp_path / "a.gltf", materials=[foil], **PICTURE)
    np.testing.assert_array_equal(quarters(load_scene(path, SKY), "id"), [[1, 0], [1, 1]])


def test_obj_textures_stand_upright(tmp_path: Path) -> None:
    (tmp_path / "a.png").write_bytes(png(IMAGE[..., :3].repeat(16, 0).repeat(16, 1)))
    (tmp_path / "a.mtl").write_text("newmtl m\nKd 0.5 1 0.25\nKe 2 3 4\nmap_Kd a.png\n")
    path = tmp_path / "a.obj"
    path.write_text(
        "mtllib a.mtl\nusemtl m\n"
        "v -0.5 0.5 0\nv -0.5 -0.5 0\nv 0.5 -0.5 0\nv 0.5 0.5 0\n"
        "vt 0 1\nvt 0 0\nvt 1 0\nvt 1 1\nf 1/1 2/2 3/3\nf 1/1 3/3 4/4\n"
    )
    scene = load_scene(path)
    np.testing.assert_allclose(quarters(scene), LINEAR[IMAGE[..., :3]] * (0.5, 1, 0.25), atol=1e-6)
    np.testing.assert_allclose(quarters(scene, "emission")[0, 0], (2, 3, 4))


def test_emission_has_its_texture(tmp_path: Path) -> None:
    lamp = {"emissiveFactor": [1.0, 0.5, 0.25], "emissiveTexture": {"index": 0}}
    scene = load_scene(write_gltf(tmp_path / "a.gltf", materials=[lamp], **PICTURE))
    np.testing.assert_allclose(quarters(scene, "emission"), LINEAR[IMAGE[..., :3]] * (1, 0.5, 0.25), atol=1e-5)


def test_a_mirrored_lamp_shines_to_the_same_side(tmp_path: Path) -> None:
    nodes = [{"mesh": 0, "scale": [-1, 1, 1]}]
    scene = load_scene(write_gltf(tmp_path / "a.gltf", materials=[{"emissiveFactor": [1, 1, 1]}], nodes=nodes))
    assert (quarters(scene, "emission") == 1).all()


def test_a_node_that_moves_is_seen_to_move(tmp_path: Path) -> None:
    buffers = Buffers()
    sampler = {"input": buffers.add([0, 1]), "output": buffers.add([[0, 0, 0], [1, 0, 0]])}
    animation = {"samplers": [sampler], "channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}]}
    scene = load_scene(write_gltf(tmp_path / "a.gltf", buffers, animations=[animation]), SKY)
    frames = [render_frame(Shot(scene, (40, 40), 2, FRONT, fps=2.0), number, jitter=False) for number in (0, 1)]
    assert [np.flatnonzero(frame.id[20])[0] for frame in frames] == [1, 20]  # half a square to the right
    assert frames[1].motion[20, 30, 0] == pytest.approx(-18.66, abs=0.01)


def test_the_camera_of_the_file_is_the_default(tmp_path: Path) -> None:
    cameras = [{"type": "perspective", "perspective": {"yfov": 0.5, "znear": 0.1}}]
    nodes = [{"mesh": 0}, {"camera": 0, "translation": [1, 2, 3]}]
    scene = load_scene(write_gltf(tmp_path / "a.gltf", nodes=nodes, cameras=cameras), SKY)
    assert scene.camera_path.at(0.0).position == (1, 2, 3)


def test_a_light_of_the_file_is_light_enough(tmp_path: Path) -> None:
    extensions = {"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": 5}]}}
    nodes = [{"mesh": 0}, {"translation": [0, 0, 2], "extensions": {"KHR_lights_punctual": {"light": 0}}}]
    scene = load_scene(write_gltf(tmp_path / "a.gltf", nodes=nodes, extensions=extensions))
    assert [light.intensity for light in scene.lights] == [(5, 5, 5)]


def test_a_file_that_emits_nothing_offers_a_sky(tmp_path: Path) -> None:
    with pytest.raises(SceneError, match=r"dark\.gltf: .*--sky"):
        load_scene(write_gltf(tmp_path / "dark.gltf"))


def test_a_folder_without_a_description_names_its_models(tmp_path: Path) -> None:
    with pytest.raises(SceneError, match=r"expected a scene\.json in this folder, found none; there is no model"):
        load_scene(tmp_path)
    for name in ("a", "b"):
        write_gltf(tmp_path / f"{name}.gltf")
    with pytest.raises(SceneError, match=r"found none; name a model to render it as it is: .*a\.gltf, .*b\.gltf"):
        load_scene(tmp_path)


def test_a_folder_is_loaded_as_described(tmp_path: Path) -> None:
    write_gltf(tmp_path / "a.gltf")
    (tmp_path / "scene.json").write_text(
        json.dumps({"model": "a.gltf", "alternative_lights": [{"type": "sky_constant", "radiance": [1, 2, 3]}]})
    )
    assert load_scene(tmp_path, alternative_lights=True).sky == (1, 2, 3)
    assert load_scene(tmp_path, SKY).sky == SKY


def test_a_file_alone_has_no_alternative_lights(tmp_path: Path) -> None:
    with pytest.raises(SceneError, match=r"expected a folder with a scene\.json"):
        load_scene(write_gltf(tmp_path / "a.gltf"), SKY, alternative_lights=True)


def test_vertex_colours_multiply_the_base_colour_and_vary_between_corners(tmp_path: Path) -> None:
    """Linear from corner to corner, whatever the material; other meshes of the scene have none."""
    buffers = Buffers()
    square, plain = buffers.square(), buffers.square(1)
    square["attributes"]["COLOR_0"] = buffers.add([(1, 0, 0, 1), (1, 0, 0, 1), (0, 0, 1, 1), (0, 0, 1, 1)])
    matt = {"extensions": {"KHR_materials_specular": {"specularFactor": 0}}}
    half = matt | {"pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.5, 0.5, 1], "metallicFactor": 0}}
    nodes = [{"mesh": 0, "translation": [0, 0.25, 0], "scale": [1, 0.5, 1]}, {"mesh": 1, "translation": [0, -0.5, 0]}]
    meshes = [{"primitives": [square]}, {"primitives": [plain]}]
    path = write_gltf(tmp_path / "a.gltf", buffers, meshes=meshes, nodes=nodes, materials=[half, half])
    albedo = quarters(load_scene(path, SKY))
    expected = [[(0.375, 0, 0.125), (0.125, 0, 0.375)], [(0.5, 0.5, 0.5), (0.5, 0.5, 0.5)]]
    np.testing.assert_allclose(albedo, expected, atol=0.02)
