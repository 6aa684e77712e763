"""Small files that once came out wrong, from ``../shared/cases``."""

from __future__ import annotations

import warnings
from pathlib import Path

import numpy as np
import pytest

from svgf_cl import Frame
from svgf_cl_tracer import Camera, CameraPath, Shot, load_scene, render_frame
from svgf_cl_tracer.gltf import load_gltf

SHARED = Path(__file__).parents[4] / "shared"
CASES = SHARED / "cases" / "gltf"
FRONT = CameraPath.static(Camera((0, 0, 2), (0, 0, 0), fov_y=30.0))

pytestmark = pytest.mark.skipif(not CASES.is_dir(), reason="needs ../shared/cases")


def front(name: str) -> Frame:
    """The file from the front; a warning about it is an error."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        scene = load_scene(CASES / name, (1.0, 1.0, 1.0))
    return render_frame(Shot(scene, (32, 32), camera_path=FRONT), 0, jitter=False)


@pytest.mark.parametrize("name", ["texcoords_float.gltf", "texcoords_uint16_normalized.gltf"])
def test_left_is_red_and_right_is_green(name: str) -> None:
    albedo = np.asarray(front(name).albedo)
    assert (albedo[16, 4] > albedo[16, 28]).tolist() == [True, False, False]
    np.testing.assert_allclose(albedo, front("texcoords_float.gltf").albedo, atol=1e-4)


def test_vertex_colours_count_beside_a_material() -> None:
    albedo = front("vertex_colours_white_material.gltf").albedo
    np.testing.assert_allclose(albedo, np.full((32, 32, 3), (1, 0, 0)), atol=0.02)  # a metal is whiter at its edge


@pytest.mark.parametrize("name", ["triangle_fan", "uri_with_percent20", "no_scenes", "accessor_of_zeros"])
def test_a_plate_covers_the_picture(name: str) -> None:
    assert np.asarray(front(f"{name}.gltf").id).all()


def test_both_instances_are_shown() -> None:
    assert set(np.unique(front("gpu_instancing.gltf").id)) == {0, 1, 2}


def test_the_view_of_an_orthographic_camera() -> None:
    """The plate is 4 wide, the view 2 high: at 16:4 the plate covers half of it. In perspective it would cover more."""
    scene = load_scene(CASES / "orthographic.gltf", (1.0, 1.0, 1.0))
    frame = render_frame(Shot(scene, (16, 64)), 0, jitter=False)
    np.testing.assert_array_equal(frame.id > 0, np.broadcast_to(np.abs(np.arange(64) - 31.5) < 16, (16, 64)))
    np.testing.assert_allclose(frame.depth[:, 16:48], 5.0, rtol=1e-6)


@pytest.mark.parametrize("bits", [8, 16])
def test_grey_textures_of_any_depth(bits: int) -> None:
    with pytest.warns(UserWarning, match="metallicRoughnessTexture"):
        scene = load_scene(CASES / f"texture_{bits}bit_grey.gltf", (1.0, 1.0, 1.0))
    frame = render_frame(Shot(scene, (8, 8), camera_path=FRONT), 0, jitter=False)
    np.testing.assert_allclose(frame.albedo, np.full((8, 8, 3), 0.245), atol=5e-4)
    np.testing.assert_allclose(frame.roughness, np.full((8, 8), 0.502), atol=5e-4)


@pytest.mark.parametrize("path", sorted((SHARED / "scenes").glob("*/*.glb")), ids=lambda path: path.stem)
def test_real_scenes_are_read_whole(path: Path) -> None:
    """But for the fox, whose bones move it."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        load_gltf(path, np.eye(4))
    expected = [
        "animations that are not played, as another one comes first: 'Walk', 'Run'",
        "meshes that are shown as they are stored, without: skins",
    ]
    found = [str(warning.message).removeprefix(f"{path}: ") for warning in caught]
    assert found == (expected if path.stem == "Fox" else [])
