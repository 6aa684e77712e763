from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest

from svgf_cl_tracer import load_scene
from svgf_cl_tracer.materials import Material
from svgf_cl_tracer.obj import load_obj, materials, model
from svgf_cl_tracer.textures import srgb_to_linear
from tests.tracer.gltf_files import png
from tests.tracer.obj.files import FACE, SQUARE, instance_of, read

PIXELS = np.arange(12, dtype=np.uint8).reshape(2, 2, 3)
POINTS = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"


def test_materials_come_from_the_mtl_beside(tmp_path: Path) -> None:
    (tmp_path / "a.png").write_bytes(png(PIXELS))
    (tmp_path / "a.mtl").write_text("newmtl m\nKd 0.5 1 0.25\nKe 2 3 4\nmap_Kd a.png\n")
    path = tmp_path / "a.obj"
    path.write_text("mtllib a.mtl\nusemtl m\nv 1 0 0\nv 0 2 0\nv 0 0 3\nvt 0 1\nvt 0 0\nvt 1 0\nf 1/1 2/2 3/3\n")
    (item,) = load_obj(path, np.diag([10.0, 10.0, 10.0, 1.0])).objects
    np.testing.assert_allclose(item.instance.corners, [10 * np.diag([1, 2, 3])])
    np.testing.assert_allclose(item.instance.uv, [[(0, 1), (0, 0), (1, 0)]])
    material = item.instance.material
    assert (item.material, material.base_colour, material.emission) == ("m", (0.5, 1, 0.25), (2, 3, 4))
    np.testing.assert_array_equal(material.base_texture, PIXELS)


def test_without_material_it_is_grey(tmp_path: Path) -> None:
    assert instance_of(tmp_path, POINTS + "f 1 2 3\n").material.base_colour == Material.base_colour


def test_nothing_outside_its_folder_is_read(tmp_path: Path) -> None:
    (tmp_path / "inner").mkdir()
    (tmp_path / "secret.mtl").write_text("newmtl m\nKd 0.5 1 0.25\n")
    loaded, lost = read(tmp_path / "inner", f"mtllib ../secret.mtl\nusemtl m\n{POINTS}f 1 2 3\n")
    assert loaded.objects[0].instance.material.base_colour == Material.base_colour
    assert lost[0] == "material libraries that are not in its folder or below: '../secret.mtl'"


def test_an_object_for_each_material_of_each_object(tmp_path: Path) -> None:
    face = "f 1 2 3\n"
    one = f"{face}o one\n{face}usemtl a\n{face}g part\n{face}"
    text = f"{POINTS}{one}o  two\t2 \n{face}usemtl b\n{face}o one\n{face}{face}"
    loaded, _ = read(tmp_path, text)
    found = [(item.nodes, item.material, len(item.instance.corners)) for item in loaded.objects]
    assert found == [
        (("a.obj", ""), "", 1),
        (("a.obj", "one"), "", 1),
        (("a.obj", "one"), "a", 2),
        (("a.obj", "two 2"), "a", 1),
        (("a.obj", "two 2"), "b", 1),
        (("a.obj", "one"), "b", 2),
    ]


def test_groups_are_objects_where_there_are_no_others(tmp_path: Path) -> None:
    loaded, _ = read(tmp_path, f"{POINTS}g a b\nf 1 2 3\ng\nf 1 2 3\n")
    assert [item.nodes for item in loaded.objects] == [("a.obj", "a b"), ("a.obj", "")]


def test_a_description_moves_and_paints_by_name(tmp_path: Path) -> None:
    (tmp_path / "a.obj").write_text(f"{POINTS}o door\nusemtl wood\nf 1 2 3\no wall\nf 1 3 4\n")
    description = {
        "model": "a.obj",
        "materials": {"wood": {"type": "diffuse", "color": [0.5, 0.25, 0]}},
        "animation": {"kind": "keyframes", "nodes": ["door"], "times_s": [0, 1], "translation": [[0, 0, 0], [1, 0, 0]]},
        "lights": [{"type": "sky_constant", "radiance": [1, 1, 1]}],
    }
    (tmp_path / "scene.json").write_text(json.dumps(description))
    with pytest.warns(UserWarning, match="no library defines"):
        door, wall = load_scene(tmp_path).instances
    assert (door.motion is not None, wall.motion) == (True, None)
    assert wall.material.base_colour == (0.5, 0.25, 0)


@pytest.mark.parametrize(
    ("line", "files"),
    [
        ("mtllib a.mtl b.mtl", ("a.mtl", "b.mtl")),
        ("mtllib a.mtl\nmtllib b.mtl", ("a.mtl", "b.mtl")),
        ("mtllib my a.mtl\nmtllib b.mtl", ("my a.mtl", "b.mtl")),
        ("mtllib sub\\A.MTL b.mtl # both", ("sub/a.mtl", "b.mtl")),
    ],
)
def test_several_libraries(tmp_path: Path, line: str, files: tuple[str, str]) -> None:
    (tmp_path / "sub").mkdir()
    for name, library in zip(files, ("newmtl a\nKd 1 0 0\n", "newmtl b\nKd 0 1 0\nnewmtl a\nKd 0\n"), strict=True):
        (tmp_path / name).write_text(library)
    loaded, lost = read(tmp_path, f"{line}\n{POINTS}usemtl a # red\nf 1 2 3\nusemtl b\nf 1 2 3\n")
    assert [item.instance.material.base_colour for item in loaded.objects] == [(1, 0, 0), (0, 1, 0)]
    assert lost == []


def test_images_lie_beside_the_library_that_names_them(tmp_path: Path) -> None:
    (tmp_path / "sub").mkdir()
    (tmp_path / "sub" / "a.png").write_bytes(png(PIXELS))
    (tmp_path / "sub" / "b.mtl").write_text("newmtl m\nmap_Kd a.png\n")
    loaded, lost = read(tmp_path, f"mtllib sub/b.mtl\n{SQUARE}usemtl m\n{FACE}")
    np.testing.assert_array_equal(loaded.objects[0].instance.material.base_texture, PIXELS)
    assert lost == []


def test_lines_that_are_not_read_are_named(tmp_path: Path) -> None:
    text = f"{POINTS}l 1 2\nl 2 3\np 1\ncstype bspline\ncurv 0 1 1 2\nparm u 0 1\nend\nlod 1\nf 1 2 3\n"
    assert read(tmp_path, text)[1] == ["lines that are not read: 'l' (2 times), 'p', 'curv'"]


def test_a_face_without_normals_among_others_is_flat(tmp_path: Path) -> None:
    instance = instance_of(
        tmp_path, POINTS + "vn 1 0 0\nvn nan 0 0\nvn 0 0 0\nf 1//1 2//1 3//1\nf 1 3 4\nf 1//1 2//2 3//3\n"
    )
    up, along = (0, 0, 1), (1, 0, 0)
    np.testing.assert_array_equal(instance.normals, [3 * [along], 3 * [up], [along, up, up]])


def test_normals_without_direction_are_none(tmp_path: Path) -> None:
    assert instance_of(tmp_path, POINTS + "vn 0 0 0\nf 1//1 2//1 3//1\n").normals is None


def test_a_smoothing_group_has_the_mean_of_the_normals_around(tmp_path: Path) -> None:
    roof = "v 0 0 0\nv 0 1 0\nv 1 1 1\nv 1 0 1\nv 2 0 0\nv 2 1 0\n"
    faces = "f 1 4 3 2\nf 4 5 6 3\n"
    smooth = instance_of(tmp_path, f"{roof}s 1\n{faces}").normals
    slope = np.array([-1, 0, 1]) / np.sqrt(2)
    np.testing.assert_allclose(smooth[0], [slope, (0, 0, 1), (0, 0, 1)], atol=1e-12)
    assert instance_of(tmp_path, f"{roof}s off\n{faces}").normals is None
    apart = instance_of(tmp_path, roof + "s 1\nf 1 4 3 2\ns 2\nf 4 5 6 3\n").normals
    np.testing.assert_allclose(apart[0], 3 * [slope], atol=1e-12)
    own = instance_of(tmp_path, roof + "vn 1 0 0\ns 1\nf 1//1 4//1 3//1 2//1\n").normals
    np.testing.assert_array_equal(own, np.broadcast_to((1, 0, 0), (2, 3, 3)))


@pytest.mark.parametrize("scale", [1, 255])
def test_vertex_colours_are_srgb_and_multiply_the_material(tmp_path: Path, scale: int) -> None:
    points = f"v 0 0 0 {scale} 0 0\nv 1 0 0 {0.5 * scale} 0 {scale}\nv 1 1 0\n"
    expected = [[(1, 0, 0), (srgb_to_linear(np.array(0.5)), 0, 1), (1, 1, 1)]]
    plain = instance_of(tmp_path, f"{points}f 1 2 3\n")
    np.testing.assert_allclose(plain.colours, expected)
    assert plain.material.base_colour == (1, 1, 1)
    loaded, lost = read(tmp_path, f"mtllib a.mtl\n{points}usemtl m\nf 1 2 3\n", "newmtl m\nKd 0.5\n")
    np.testing.assert_allclose(loaded.objects[0].instance.colours, expected)
    assert (loaded.objects[0].instance.material.base_colour, lost) == ((0.5, 0.5, 0.5), [])


def test_the_page_names_all_that_is_read() -> None:
    page = (Path(__file__).parents[3] / "docs" / "scenes.md").read_text()
    obj, mtl = page.split("| in the .obj file |")[1].split("### ")[0].split("| in the .mtl file |")
    assert first_column(obj) == model.READ
    assert first_column(mtl) - {"illum", "ks", "tf"} == materials.READ | materials.INVISIBLE


def first_column(table: str) -> set[str]:
    """The keywords in the first column of a table."""
    return {name.lower() for row in table.splitlines() for name in re.findall(r"`(\w+)`", row[: row.find("|", 1)])}
