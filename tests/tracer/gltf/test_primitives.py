from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from svgf_cl_tracer import SceneError
from svgf_cl_tracer.gltf.file import Gltf
from svgf_cl_tracer.gltf.primitives import (
    MODES,
    TRIANGLE_FAN,
    TRIANGLE_STRIP,
    TRIANGLES,
    Primitive,
    is_shown,
    read_primitive,
    triangles,
)
from svgf_cl_tracer.gltf.textures import Coordinates
from tests.tracer.gltf_files import CORNERS, NORMAL, TEXCOORDS, Buffers, write_gltf


def read(folder: Path, buffers: Buffers, primitive: dict[str, Any], number: int = 0) -> Primitive:
    gltf = Gltf.read(write_gltf(folder / "a.gltf", buffers, meshes=[{"primitives": [primitive]}]))
    return read_primitive(gltf, primitive, Coordinates(number))


def facing(corners: np.ndarray, faces: np.ndarray) -> np.ndarray:
    a, b, c = np.moveaxis(corners[faces], 1, 0)
    return np.cross(b - a, c - a)


def test_every_mode_has_its_triangles() -> None:
    corners = np.array([5, 6, 7, 8, 9])
    assert triangles(corners, TRIANGLES).tolist() == [[5, 6, 7]]
    assert triangles(corners, TRIANGLE_STRIP).tolist() == [[5, 6, 7], [6, 8, 7], [7, 8, 9]]
    assert triangles(corners, TRIANGLE_FAN).tolist() == [[6, 7, 5], [7, 8, 5], [8, 9, 5]]


@given(st.integers(3, 40))
def test_strips_and_fans_face_the_way_of_their_first_triangle(count: int) -> None:
    angles = np.linspace(0, 6, count)
    disc = np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=1)
    ribbon = np.stack([np.arange(count) // 2, -(np.arange(count) % 2), np.zeros(count)], axis=1)
    for corners, mode in ((disc, TRIANGLE_FAN), (ribbon, TRIANGLE_STRIP)):
        faces = triangles(np.arange(count), mode)
        assert len(faces) == count - 2
        assert (facing(corners, faces)[:, 2] > 0).all()


@pytest.mark.parametrize("mode", range(TRIANGLES, len(MODES)))
@pytest.mark.parametrize("count", range(3))
def test_too_few_corners_make_nothing(mode: int, count: int) -> None:
    assert triangles(np.arange(count), mode).shape == (0, 3)


@pytest.mark.parametrize("mode", range(len(MODES)))
def test_points_and_lines_are_not_shown(mode: int) -> None:
    assert is_shown({"attributes": {"POSITION": 0}, "mode": mode}) == MODES[mode].startswith("triangle")
    assert not is_shown({"attributes": {}, "mode": mode})


def test_another_mode_is_refused() -> None:
    with pytest.raises(SceneError, match="mode: expected an index from 0 and below 7, found 7"):
        is_shown({"attributes": {"POSITION": 0}, "mode": 7})


@pytest.mark.parametrize("kind", ["<u1", "<u2", "<u4"])
def test_indices_are_of_any_size(kind: str, tmp_path: Path) -> None:
    buffers = Buffers()
    square = buffers.square() | {"indices": buffers.add([2, 1, 0], kind)}
    assert read(tmp_path, buffers, square).mesh.faces.tolist() == [[2, 1, 0]]


def test_without_indices_corners_follow_one_another(tmp_path: Path) -> None:
    buffers = Buffers()
    primitive = {"attributes": {"POSITION": buffers.add(CORNERS)}, "mode": TRIANGLE_FAN}
    assert read(tmp_path, buffers, primitive).mesh.faces.tolist() == [[1, 2, 0], [2, 3, 0]]


@pytest.mark.parametrize(("indices", "kind"), [([0, 1, 4], "<u2"), ([0, 1, -1], "<i2"), ([0.0, 1.0, 2.0], "<f4")])
def test_indices_of_what_is_not_there_are_refused(indices: list[float], kind: str, tmp_path: Path) -> None:
    buffers = Buffers()
    square = buffers.square() | {"indices": buffers.add(indices, kind)}
    with pytest.raises(SceneError, match=r"accessors\[3\]: expected whole numbers from 0 and below 4"):
        read(tmp_path, buffers, square)


@pytest.mark.parametrize(("kind", "most"), [("<u1", 255), ("<u2", 65535), ("<i1", 127), ("<i2", 32767)])
def test_integers_stand_for_fractions_everywhere(kind: str, most: int, tmp_path: Path) -> None:
    """KHR_mesh_quantization allows them for all attributes; texture coordinates and colours have them without it."""
    buffers, whole = Buffers(), {"normalized": True}
    colours = np.array([[1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]])
    attributes = {
        "POSITION": buffers.add((CORNERS + 0.5) * most, kind, **whole),
        "NORMAL": buffers.add([[0, 0, most]] * 4, kind, **whole),
        "TEXCOORD_0": buffers.add(TEXCOORDS * most, kind, **whole),
        "COLOR_0": buffers.add(colours * most, kind, **whole),
    }
    mesh = read(tmp_path, buffers, {"attributes": attributes}).mesh
    np.testing.assert_allclose(mesh.vertices, CORNERS + 0.5, atol=0.01)
    np.testing.assert_array_equal(mesh.normals, [[0, 0, 1]] * 4)
    np.testing.assert_array_equal(mesh.uv, TEXCOORDS * (1, -1) + (0, 1))
    np.testing.assert_array_equal(mesh.colours, colours)


@pytest.mark.parametrize("kind", ["<u1", "<u2", "<i1", "<i2"])
def test_positions_of_whole_numbers_are_these(kind: str, tmp_path: Path) -> None:
    buffers = Buffers()
    mesh = read(tmp_path, buffers, {"attributes": {"POSITION": buffers.add([[0, 7, 100]] * 3, kind)}}).mesh
    np.testing.assert_array_equal(mesh.vertices, [[0, 7, 100]] * 3)


def test_colours_have_three_or_four_channels_and_end_at_0_and_1(tmp_path: Path) -> None:
    colours = [[0.2, 0.4, 0.6, 0.5], [-1, 2, 0, 1], [0, 0, 0, 0], [1, 1, 1, 1]]
    for columns in (3, 4):
        buffers = Buffers()
        square = buffers.square()
        square["attributes"]["COLOR_0"] = buffers.add(np.array(colours)[:, :columns])
        found = read(tmp_path, buffers, square).mesh.colours
        np.testing.assert_allclose(found, [[0.2, 0.4, 0.6], [0, 1, 0], [0, 0, 0], [1, 1, 1]], atol=1e-7)


def test_that_set_of_texture_coordinates_is_read_which_the_material_wants(tmp_path: Path) -> None:
    buffers = Buffers()
    square = buffers.square(normals=True)
    square["attributes"]["TEXCOORD_1"] = buffers.add(TEXCOORDS / 2)
    np.testing.assert_array_equal(read(tmp_path, buffers, square, 1).mesh.uv, TEXCOORDS * (0.5, -0.5) + (0, 1))
    np.testing.assert_allclose(read(tmp_path, buffers, square).mesh.normals, [NORMAL] * 4, atol=1e-7)
    assert read(tmp_path, buffers, square, 2).mesh.uv is None


@pytest.mark.parametrize("name", ["NORMAL", "TEXCOORD_0", "COLOR_0"])
def test_attributes_are_as_many_as_positions(name: str, tmp_path: Path) -> None:
    buffers = Buffers()
    square = buffers.square()
    square["attributes"][name] = buffers.add(np.zeros((3, 2 if name == "TEXCOORD_0" else 3)))
    with pytest.raises(SceneError, match=f"{name}: expected as many as of POSITION, 4, found 3"):
        read(tmp_path, buffers, square)


def test_a_compressed_mesh_is_read_where_the_file_also_holds_it_plain(tmp_path: Path) -> None:
    buffers = Buffers()
    square = buffers.square() | {"extensions": {"KHR_draco_mesh_compression": {}}}
    np.testing.assert_array_equal(read(tmp_path, buffers, square).mesh.vertices, CORNERS)
    del buffers.accessors[0]["bufferView"]
    with pytest.raises(SceneError, match="found those of KHR_draco_mesh_compression alone; export it without"):
        read(tmp_path, buffers, square)
