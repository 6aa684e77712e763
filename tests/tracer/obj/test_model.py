from __future__ import annotations

from pathlib import Path

import numpy as np

from svgf_cl_tracer.obj import load_obj
from tests.tracer.gltf_files import png

PIXELS = np.arange(12, dtype=np.uint8).reshape(2, 2, 3)


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
    path = tmp_path / "a.obj"
    path.write_text("v -9 -9 0\nv 9 -9 0\nv 0 9 0\nf 1 2 3\n")
    (item,) = load_obj(path, np.eye(4)).objects
    assert item.instance.material.base_colour == (0.8, 0.8, 0.8)


def test_nothing_outside_its_folder_is_read(tmp_path: Path) -> None:
    (tmp_path / "inner").mkdir()
    (tmp_path / "secret.mtl").write_text("newmtl m\nKd 0.5 1 0.25\n")
    path = tmp_path / "inner" / "a.obj"
    path.write_text("mtllib ../secret.mtl\nusemtl m\nv 1 0 0\nv 0 2 0\nv 0 0 3\nf 1 2 3\n")
    (item,) = load_obj(path, np.eye(4)).objects
    assert item.instance.material.base_colour != (0.5, 1, 0.25)
