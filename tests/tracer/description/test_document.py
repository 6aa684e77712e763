from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from svgf_cl_tracer import SceneError
from svgf_cl_tracer.description import SceneDescription, document, read_description

SHARED = Path(__file__).parents[4] / "shared" / "scenes"
SCENES = sorted(SHARED.glob("*/scene.json"))

CAMERA = {"position": [0, 0, 2], "look_at": [0, 0, 0]}
WHOLE = {
    "model": "a.glb",
    "camera": CAMERA,
    "lights": [{"type": "sun", "direction_to_light": [0, 1, 0], "irradiance": [1, 1, 1]}],
    "materials": {"wood": {"type": "plastic", "roughness": 0.5}, "glass": {"type": "dielectric"}},
    "animation": {"kind": "rigid rotation about +Y", "nodes": ["door"], "angle_deg": [0, -40]},
}


def read(folder: Path, content: Any) -> SceneDescription:
    path = folder / "scene.json"
    path.write_text(content if isinstance(content, str) else json.dumps(content))
    return read_description(path)


@pytest.mark.skipif(not SCENES, reason=f"no scenes in {SHARED}")
@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.parent.name)
def test_shared_scenes_are_understood(path: Path) -> None:
    assert read_description(path).model.endswith(".glb")


def test_the_least_is_a_model(tmp_path: Path) -> None:
    description = read(tmp_path, {"model": "a.glb"})
    assert (description.views(), description.animations(), description.lights) == ([], [], [])
    np.testing.assert_array_equal(description.to_world(), np.eye(4))


def test_one_camera_or_several(tmp_path: Path) -> None:
    for camera in (CAMERA, [CAMERA, CAMERA]):
        views = read(tmp_path, {"model": "a.glb", "camera": camera}).views()
        assert [view.camera().position for view in views] == len(views) * [(0, 0, 2)]
        assert len(views) == (2 if isinstance(camera, list) else 1)


def test_one_animation_or_several(tmp_path: Path) -> None:
    turn = WHOLE["animation"]
    assert len(read(tmp_path, {"model": "a.glb", "animation": turn}).animations()) == 1
    assert len(read(tmp_path, {"model": "a.glb", "animation": [turn, turn]}).animations()) == 2


def test_a_model_in_centimetres_whose_z_is_up(tmp_path: Path) -> None:
    to_world = read(tmp_path, {"model": "a.obj", "up_axis": "z", "metres_per_unit": 0.01}).to_world()
    np.testing.assert_allclose(to_world @ (100, 200, 300, 1), (1, 3, -2, 1))
    assert np.linalg.det(to_world) > 0


def change(path: str, value: Any) -> Callable[[dict[str, Any]], None]:
    """What sets the value at a path such as ``camera.up``."""

    def apply(content: dict[str, Any]) -> None:
        *parents, last = path.split(".")
        for name in parents:
            content = content[int(name) if isinstance(content, list) else name]
        content[last] = value

    return apply


STILL = {"kind": "keyframes", "nodes": ["door"], "times_s": [0], "rotation": [[0, 0, 0, 0]]}
SUN_AND_SKIES = [WHOLE["lights"][0], *2 * [{"type": "sky_constant", "radiance": [1, 1, 1]}]]


@pytest.mark.parametrize(
    ("path", "value", "complaint"),
    [
        ("camera.fov_y_deg", 200, "camera.fov_y_deg: expected less than 180, found 200"),
        ("camera.fov_y_deg", "20", "camera.fov_y_deg: expected a valid number, found '20'"),
        ("camera.fov_y_deg", float("nan"), "camera.fov_y_deg: expected a finite number, found nan"),
        ("camera.aperture", True, "camera.aperture: expected a valid number, found True"),
        ("camera.fov", 20, "camera.fov: expected a field that is known, found one that is not; docs/scene"),
        ("camera", {"look_at": [0, 0, 0]}, "camera.position: expected a value, found none; docs/scene_description.md"),
        ("camera.up", [0, 1], "camera.up[2]: expected a value, found none"),
        ("camera", [CAMERA, {**CAMERA, "shutter": 2}], "camera[1].shutter: expected less than or equal to 1, found 2"),
        ("camera", 3, "camera: expected an object, found 3"),
        ("lights.0.irradiance", [1, -1, 1], "lights[0].irradiance[1]: expected greater than or equal to 0, found -1"),
        ("lights.0.type", "lamp", "lights[0]: expected 'type' to be one of 'sun', 'sky_constant', "),
        ("lights", [{}], "lights[0]: expected a field 'type', found none"),
        ("lights", SUN_AND_SKIES, "lights: expected at most one sky, found sky_constant, sky_constant"),
        ("materials.wood.alpha", 0.3, "materials.wood: expected as alpha the square of the roughness 0.5, found 0.3"),
        ("materials.glass.roughness", 0.3, "materials.glass.roughness: expected less than or equal to 0, found 0.3"),
        ("materials.wood.type", "wood", "materials.wood: expected 'type' to be one of 'diffuse', 'plastic', "),
        ("animation.times_s", [1, 2, 3], "animation: expected as many times_s as angle_deg, 2, found 3"),
        (
            "animation.angle_deg",
            [0, 90, 270],
            "animation: expected angles less than 180 apart, found [0.0, 90.0, 270.0]",
        ),
        ("animation", STILL, "animation: expected quaternions of a length above 0 as rotation, found one of 0"),
        ("animation.nodes", [], "animation.nodes: expected at least 1 item, found []"),
        (
            "animation",
            [{"kind": "keyframes", "nodes": ["a"], "times_s": [0]}],
            "animation[0]: expected a translation, ",
        ),
        ("up_axis", "x", "up_axis: expected 'y' or 'z', found 'x'"),
        ("model", 30 * "ab " + "c", "model: expected"),
    ],
)
def test_complaints_name_field_expected_and_found(tmp_path: Path, path: str, value: Any, complaint: str) -> None:
    content = json.loads(json.dumps(WHOLE))
    read(tmp_path, content)
    if path == "model":
        value = [value]
    change(path, value)(content)
    with pytest.raises(SceneError) as caught:
        read(tmp_path, content)
    message = str(caught.value)
    assert message.startswith(f"{tmp_path / 'scene.json'}: {complaint}")
    assert "\n" not in message
    assert len(message) < len(str(tmp_path)) + 240


@pytest.mark.parametrize("text", ["", "{", "[]", "nothing of the kind"])
def test_what_is_no_object_of_json_is_named(tmp_path: Path, text: str) -> None:
    with pytest.raises(SceneError, match=r"scene\.json: (Invalid JSON|the file: expected an object)"):
        read(tmp_path, text)


def test_a_huge_file_is_not_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(document, "MAX_BYTES", 10)
    with pytest.raises(SceneError, match="expected at most 10 bytes, found"):
        read(tmp_path, WHOLE)
