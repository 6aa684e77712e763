from __future__ import annotations

import base64
import io
import json
from pathlib import Path
from typing import Any

import numpy as np
import PIL.Image
import pytest

from tracer import Camera, Scene, SceneError, load_scene, render_frame
from tracer.textures import LINEAR

SKY = (1.0, 1.0, 1.0)
# Red and green above blue and white.
IMAGE = np.array([[(255, 0, 0), (0, 255, 0)], [(0, 0, 255), (255, 255, 255)]], np.uint8)
# Attributes of the test mesh, without and with normals; these lean towards +x and +y.
FLAT = {"POSITION": 0, "TEXCOORD_0": 1}
SMOOTH = FLAT | {"NORMAL": 3}
NORMAL = (0.48, 0.36, 0.8)
# Sees the unit square around the origin, and a little more.
FRONT = Camera((0, 0, 2), (0, 0, 0), fov_y=30.0)


def png() -> bytes:
    stream = io.BytesIO()
    PIL.Image.fromarray(IMAGE.repeat(16, 0).repeat(16, 1)).save(stream, "png")
    return stream.getvalue()


def uri(data: bytes, kind: str) -> str:
    return f"data:{kind};base64,{base64.b64encode(data).decode()}"


def gltf(
    path: Path,
    material: dict[str, Any],
    nodes: list[dict[str, Any]],
    attributes: dict[str, int] = FLAT,
    **more: Any,
) -> Path:
    """Write a .gltf with one mesh, a unit square in the plane z = 0 whose front and top are +z and +y.

    Without `attributes` of its own the mesh has no normals; those of accessor 3 are `NORMAL`.
    """
    positions = np.array([(-0.5, 0.5, 0), (-0.5, -0.5, 0), (0.5, -0.5, 0), (0.5, 0.5, 0)], "<f4")
    normals = np.array(4 * [NORMAL], "<f4")
    texcoords = np.array([(0, 0), (0, 1), (1, 1), (1, 0)], "<f4")  # glTF: v points down
    indices = np.array([0, 1, 2, 0, 2, 3], "<u4")
    parts = [positions.tobytes(), texcoords.tobytes(), indices.tobytes(), normals.tobytes()]
    starts = np.cumsum([0, *map(len, parts)])
    document = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": list(range(len(nodes)))}],
        "nodes": nodes,
        "meshes": [
            {"primitives": [{"attributes": attributes, "indices": 2, "material": 0}]},
        ],
        "materials": [material],
        "textures": [{"source": 0}],
        "images": [{"uri": uri(png(), "image/png")}],
        "accessors": [
            {
                "bufferView": 0,
                "componentType": 5126,
                "count": 4,
                "type": "VEC3",
                "min": positions.min(0).tolist(),
                "max": positions.max(0).tolist(),
            },
            {"bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC2"},
            {"bufferView": 2, "componentType": 5125, "count": 6, "type": "SCALAR"},
            {"bufferView": 3, "componentType": 5126, "count": 4, "type": "VEC3"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteOffset": int(start), "byteLength": len(part)}
            for start, part in zip(starts, parts, strict=False)
        ],
        "buffers": [{"uri": uri(b"".join(parts), "application/octet-stream"), "byteLength": int(starts[-1])}],
    }
    path.write_text(json.dumps(document | more))
    return path


def quarters(scene: Scene) -> np.ndarray:
    """Albedo (2, 2, 3) in the middle of each quarter of the square as seen from the front."""
    frame = render_frame(scene, FRONT, None, (40, 40), jitter=False)
    return np.asarray(frame.albedo[10:31:20, 10:31:20])


def test_gltf_textures_stand_upright(tmp_path: Path) -> None:
    material = {"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}, "baseColorFactor": [0.5, 1, 0.25, 1]}}
    scene = load_scene(gltf(tmp_path / "a.gltf", material, [{"mesh": 0}]), sky=SKY)
    np.testing.assert_allclose(quarters(scene), LINEAR[IMAGE] * (0.5, 1, 0.25), atol=1e-6)


def test_obj_textures_stand_upright(tmp_path: Path) -> None:
    (tmp_path / "a.png").write_bytes(png())
    (tmp_path / "a.mtl").write_text("newmtl m\nKd 0.5 1 0.25\nKe 2 3 4\nmap_Kd a.png\n")
    path = tmp_path / "a.obj"
    path.write_text(
        "mtllib a.mtl\nusemtl m\n"
        "v -0.5 0.5 0\nv -0.5 -0.5 0\nv 0.5 -0.5 0\nv 0.5 0.5 0\n"
        "vt 0 1\nvt 0 0\nvt 1 0\nvt 1 1\nf 1/1 2/2 3/3\nf 1/1 3/3 4/4\n"
    )
    scene = load_scene(path)
    np.testing.assert_allclose(quarters(scene), LINEAR[IMAGE] * (0.5, 1, 0.25), atol=1e-6)
    np.testing.assert_allclose(render_frame(scene, FRONT, None, (9, 9)).emission[4, 4], (2, 3, 4))


def test_an_obj_without_material_is_grey(tmp_path: Path) -> None:
    path = tmp_path / "a.obj"
    path.write_text("v -9 -9 0\nv 9 -9 0\nv 0 9 0\nf 1 2 3\n")
    np.testing.assert_allclose(render_frame(load_scene(path, sky=SKY), FRONT, None, (3, 3)).albedo, 0.8)


def test_colours_are_not_rounded_to_8_bits(tmp_path: Path) -> None:
    material = {"pbrMetallicRoughness": {"baseColorFactor": [0.0123, 0.4567, 0.8912, 1]}}
    scene = load_scene(gltf(tmp_path / "a.gltf", material, [{"mesh": 0}]), sky=SKY)
    np.testing.assert_allclose(quarters(scene)[0, 0], (0.0123, 0.4567, 0.8912), rtol=1e-6)


def test_emission_has_its_strength_and_its_texture(tmp_path: Path) -> None:
    material = {
        "emissiveFactor": [1.0, 0.5, 0.25],
        "emissiveTexture": {"index": 0},
        "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 8.0}},
    }
    scene = load_scene(gltf(tmp_path / "a.gltf", material, [{"mesh": 0}]))
    emission = render_frame(scene, FRONT, None, (40, 40), jitter=False).emission[10:31:20, 10:31:20]
    np.testing.assert_allclose(emission, LINEAR[IMAGE] * (8, 4, 2), atol=1e-5)


def test_each_node_is_an_instance_in_its_place(tmp_path: Path) -> None:
    nodes = [{"mesh": 0, "name": "a", "translation": [-1, 0, 0]}, {"mesh": 0, "name": "b", "translation": [1, 0, 0]}]
    scene = load_scene(gltf(tmp_path / "a.gltf", {}, nodes), sky=SKY)
    ids = render_frame(scene, Camera((0, 0, 4), (0, 0, 0)), None, (41, 41), jitter=False).id
    assert set(ids[:, :20].ravel()) == {0, 1} or set(ids[:, :20].ravel()) == {0, 2}
    assert set(ids.ravel()) == {0, 1, 2}
    assert (ids[:, 20] == 0).all()


def test_a_mirrored_lamp_shines_to_the_same_side(tmp_path: Path) -> None:
    nodes = [{"mesh": 0, "scale": [-1, 1, 1]}]
    scene = load_scene(gltf(tmp_path / "a.gltf", {"emissiveFactor": [1, 1, 1]}, nodes))
    assert (render_frame(scene, FRONT, None, (9, 9)).emission[4, 4] == 1).all()


def test_the_camera_of_the_file_is_the_default(tmp_path: Path) -> None:
    cameras = [{"type": "perspective", "perspective": {"yfov": 0.5, "znear": 0.1, "aspectRatio": 1.5}}]
    nodes = [{"mesh": 0}, {"camera": 0, "translation": [1, 2, 3]}]
    scene = load_scene(gltf(tmp_path / "a.gltf", {}, nodes, cameras=cameras), sky=SKY)
    camera = scene.camera_path.at(0.0)
    np.testing.assert_allclose(camera.position, (1, 2, 3))
    np.testing.assert_allclose(camera.basis(), [(1, 0, 0), (0, 1, 0), (0, 0, -1)], atol=1e-9)
    assert camera.fov_y == pytest.approx(np.degrees(0.5))


def test_a_file_that_emits_nothing_offers_a_sky(tmp_path: Path) -> None:
    path = gltf(tmp_path / "dark.gltf", {}, [{"mesh": 0}])
    with pytest.raises(SceneError, match=r"dark\.gltf: .*--sky"):
        load_scene(path)


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(SceneError, match=r"nowhere\.glb: no such file"):
        load_scene(tmp_path / "nowhere.glb")


@pytest.mark.parametrize("name", ["a.glb", "a.gltf", "a.obj", "a.xyzzy"])
def test_an_unreadable_file_is_named(tmp_path: Path, name: str) -> None:
    path = tmp_path / name
    path.write_bytes(b"\0\1\2 nothing of the kind")
    with pytest.raises(SceneError, match=name) as caught:
        load_scene(path, sky=SKY)
    assert "\n" not in str(caught.value)


def test_an_unreadable_texture_is_named(tmp_path: Path) -> None:
    material = {"name": "brick", "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}
    path = gltf(tmp_path / "a.gltf", material, [{"mesh": 0}], images=[{"uri": uri(b"no png", "image/png")}])
    with pytest.raises(SceneError, match="baseColorTexture of material 'brick'"):
        load_scene(path, sky=SKY)


@pytest.mark.parametrize("scale", [(1, 1, 1), (1, 1, 0.5), (1, -1, 2), (1e-7, 1e-7, 1e-7), (-1, 1, 1)])
def test_normals_turn_with_what_they_stand_on(tmp_path: Path, scale: tuple[float, float, float]) -> None:
    scene = load_scene(gltf(tmp_path / "a.gltf", {}, [{"mesh": 0, "scale": scale}], SMOOTH), sky=SKY)
    camera = Camera((0, 0, 2 * abs(scale[0])), (0, 0, 0), fov_y=30.0)
    expected = np.array(NORMAL) / scale
    expected *= np.sign(expected[2]) / np.linalg.norm(expected)
    np.testing.assert_allclose(render_frame(scene, camera, None, (9, 9)).normal[4, 4], expected, atol=1e-6)


@pytest.mark.parametrize("scale", [(1, 1, 0), (1, 0, 1), (0, 0, 0)])
def test_a_flattened_object_is_no_error(tmp_path: Path, scale: tuple[float, float, float]) -> None:
    nodes = [{"mesh": 0}, {"mesh": 0, "scale": scale, "translation": [0, 0, 0.1]}]
    frame = render_frame(load_scene(gltf(tmp_path / "a.gltf", {}, nodes, SMOOTH), sky=SKY), FRONT, None, (9, 9))
    assert np.isfinite(frame.color).all()
    expected = (0, 0, 1) if scale == (1, 1, 0) else NORMAL
    np.testing.assert_allclose(frame.normal[4, 4], expected, atol=1e-6)


def test_an_extension_that_is_null_is_absent(tmp_path: Path) -> None:
    material = {"emissiveFactor": [1, 1, 1], "extensions": {"KHR_materials_emissive_strength": None}}
    scene = load_scene(gltf(tmp_path / "a.gltf", material, [{"mesh": 0}]))
    assert (render_frame(scene, FRONT, None, (9, 9)).emission[4, 4] == 1).all()


@pytest.mark.parametrize("emission", [[np.nan, 0, 0], [np.inf, 1, 1]])
def test_emission_without_sense_is_refused(tmp_path: Path, emission: list[float]) -> None:
    path = gltf(tmp_path / "a.gltf", {"emissiveFactor": emission}, [{"mesh": 0}])
    with pytest.raises(SceneError, match=r"a\.gltf: material: expected a finite emission >= 0"):
        load_scene(path)


@pytest.mark.parametrize(
    "material",
    [{"emissiveFactor": [1, 2]}, {"pbrMetallicRoughness": 3}, {"extensions": [1]}, {"emissiveFactor": "red"}],
)
def test_material_without_sense_is_one_line_that_names_the_file(tmp_path: Path, material: dict[str, Any]) -> None:
    path = gltf(tmp_path / "a.gltf", material, [{"mesh": 0}])
    with pytest.raises(SceneError, match=r"a\.gltf: cannot be read") as caught:
        load_scene(path, sky=SKY)
    assert "\n" not in str(caught.value)
