from __future__ import annotations

import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from svgf_cl_tracer import SceneError
from svgf_cl_tracer.gltf.file import Gltf
from tests.tracer.gltf_files import CORNERS, Buffers, document, glb, write_gltf


def test_text_and_binary_files_hold_the_same(tmp_path: Path) -> None:
    buffers = Buffers()
    text = write_gltf(tmp_path / "a.gltf", buffers)
    binary = tmp_path / "a.glb"
    binary.write_bytes(glb(document(buffers, buffers=[{"byteLength": len(buffers.data)}]), buffers.data))
    for path in (text, binary):
        gltf = Gltf.read(path)
        np.testing.assert_array_equal(gltf.numbers(0), CORNERS)
        np.testing.assert_array_equal(gltf.meshes()[0][0].vertices, CORNERS)


def test_a_buffer_may_be_a_file_beside_but_nowhere_else(tmp_path: Path) -> None:
    (tmp_path / "inner").mkdir()
    buffers = Buffers()
    buffers.square()
    for folder in (tmp_path, tmp_path / "inner"):
        (folder / f"{folder.name}.bin").write_bytes(buffers.data)
    beside = write_gltf(tmp_path / "inner" / "a.gltf", buffers, buffers=[{"uri": "inner.bin"}])
    assert Gltf.read(beside).numbers(0).shape == (4, 3)
    outside = write_gltf(tmp_path / "inner" / "b.gltf", buffers, buffers=[{"uri": f"../{tmp_path.name}.bin"}])
    with pytest.raises(ValueError, match="escapes"):
        Gltf.read(outside).numbers(0)


def test_numbers_may_lie_between_others(tmp_path: Path) -> None:
    buffers = Buffers()
    buffers.add([[1, 2, 3, -1], [4, 5, 6, -1]])
    buffers.views[0]["byteStride"] = 16
    buffers.accessors[0] |= {"type": "VEC2", "byteOffset": 4}
    path = write_gltf(tmp_path / "a.gltf", buffers)
    np.testing.assert_array_equal(Gltf.read(path).numbers(0), [[2, 3], [5, 6]])


def test_integers_that_stand_for_fractions(tmp_path: Path) -> None:
    buffers = Buffers()
    buffers.add([[-128, -127, 0, 127]], "<i1", normalized=True)
    buffers.add([[0, 65535]], "<u2", normalized=True)
    gltf = Gltf.read(write_gltf(tmp_path / "a.gltf", buffers))
    np.testing.assert_array_equal(gltf.numbers(0), [[-1, -1, 0, 1]])
    np.testing.assert_array_equal(gltf.numbers(1), [[0, 1]])


def test_a_buffer_too_short_is_refused(tmp_path: Path) -> None:
    buffers = Buffers()
    buffers.add([[1, 2, 3]], count=10**12)
    with pytest.raises(ValueError, match="size of buffer"):
        Gltf.read(write_gltf(tmp_path / "a.gltf", buffers)).numbers(0)


@pytest.mark.parametrize("change", [{"sparse": {"count": 1}}, {"bufferView": None}])
def test_what_is_sparse_or_compressed_is_refused(tmp_path: Path, change: dict[str, Any]) -> None:
    buffers = Buffers()
    square = buffers.square()
    accessor = buffers.accessors[square["attributes"]["POSITION"]]
    accessor |= change
    if accessor["bufferView"] is None:
        del accessor["bufferView"]
    gltf = Gltf.read(write_gltf(tmp_path / "a.gltf", buffers, meshes=[{"primitives": [square]}]))
    for read in (gltf.meshes, lambda: gltf.numbers(0)):
        with pytest.raises(SceneError, match=r"accessors\[0\]: expected plain data, found sparse"):
            read()


def test_no_room_is_made_for_numbers_that_nothing_shows(tmp_path: Path) -> None:
    buffers = Buffers()
    square = buffers.square()
    buffers.accessors.append({"componentType": 5126, "count": 10**15, "type": "VEC3"})
    gltf = Gltf.read(write_gltf(tmp_path / "a.gltf", buffers, meshes=[{"primitives": [square]}]))
    assert len(gltf.meshes()[0][0].faces) == 2


def test_meshes_come_by_index_with_a_part_for_each_primitive(tmp_path: Path) -> None:
    buffers = Buffers()
    points = {"attributes": {"POSITION": 0}, "mode": 0}
    meshes = [
        {"name": "same", "primitives": [buffers.square(1), buffers.square(0), points]},
        {"name": "same", "primitives": [buffers.square(1)], "extras": {"mesh": 7}},
    ]
    materials = [{"name": "a"}, {"name": "a"}]
    found = Gltf.read(write_gltf(tmp_path / "a.gltf", buffers, meshes=meshes, materials=materials)).meshes()
    assert {index: [part.visual.material.name for part in parts] for index, parts in found.items()} == {
        0: ["1", "0"],
        1: ["1"],
    }


def test_an_extension_that_the_file_cannot_be_shown_without_is_named(tmp_path: Path) -> None:
    path = write_gltf(tmp_path / "a.gltf", extensionsRequired=["KHR_lights_punctual", "EXT_strange"])
    with pytest.raises(SceneError, match=r"extensionsRequired: .* found \['EXT_strange'\]"):
        Gltf.read(path)


@pytest.mark.parametrize("data", [b"", b"not json", b"glTF", b"glTF" + bytes(40)])
def test_anything_else_is_refused(tmp_path: Path, data: bytes) -> None:
    path = tmp_path / "a.glb"
    path.write_bytes(data)
    with pytest.raises((ValueError, struct.error)):
        Gltf.read(path)
