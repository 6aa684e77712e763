from __future__ import annotations

import itertools
import json
import struct
from pathlib import Path

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


def test_chunks_of_a_binary_file_are_told_by_their_kind(tmp_path: Path) -> None:
    """Whatever lies before, between and behind them."""
    buffers = Buffers()
    buffers.add([[1, 2, 3]])
    text = json.dumps({"accessors": buffers.accessors, "bufferViews": buffers.views, "buffers": [{"byteLength": 12}]})
    parts = {b"ABCD": b"else", b"BIN\0": buffers.data, b"JSON": text.encode()}
    for order in itertools.permutations(parts):
        chunks = b"".join(struct.pack("<I4s", len(parts[kind]), kind) + parts[kind] for kind in order)
        (tmp_path / "a.glb").write_bytes(struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks)
        np.testing.assert_array_equal(Gltf.read(tmp_path / "a.glb").numbers(0), [[1, 2, 3]])


def test_a_file_of_version_1_is_refused(tmp_path: Path) -> None:
    path = write_gltf(tmp_path / "a.gltf", asset={"version": "1.0"})
    with pytest.raises(SceneError, match=r"asset\.version: expected glTF 2\.0, found '1\.0'"):
        Gltf.read(path)


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


def test_an_accessor_without_a_buffer_view_is_of_zeros(tmp_path: Path) -> None:
    buffers = Buffers()
    buffers.accessors.append({"componentType": 5126, "count": 2, "type": "VEC3"})
    np.testing.assert_array_equal(Gltf.read(write_gltf(tmp_path / "a.gltf", buffers)).numbers(0), np.zeros((2, 3)))


@pytest.mark.parametrize("kind", ["<u1", "<u2", "<u4"])
@pytest.mark.parametrize("based", [True, False])
def test_sparse_values_replace_those_below(based: bool, kind: str, tmp_path: Path) -> None:
    """Also where nothing is below: zeros."""
    buffers = Buffers()
    below = np.arange(12.0).reshape(4, 3) if based else np.zeros((4, 3))
    buffers.add(below)
    places, values = buffers.add([1, 3], kind), buffers.add([[10, 20, 30], [40, 50, 60]])
    sparse = {
        "count": 2,
        "indices": {"bufferView": places, "componentType": buffers.accessors[places]["componentType"]},
        "values": {"bufferView": values},
    }
    buffers.accessors[0]["sparse"] = sparse
    if not based:
        del buffers.accessors[0]["bufferView"]
    below[[1, 3]] = [[10, 20, 30], [40, 50, 60]]
    np.testing.assert_array_equal(Gltf.read(write_gltf(tmp_path / "a.gltf", buffers)).numbers(0), below)


@pytest.mark.parametrize(("places", "kind"), [([4], "<u1"), ([-1], "<i1"), ([0.0], "<f4")])
def test_sparse_values_lie_within_the_others(places: list[int], kind: str, tmp_path: Path) -> None:
    buffers = Buffers()
    buffers.add(np.zeros((4, 3)))
    index, values = buffers.add(places, kind), buffers.add([[1, 2, 3]])
    indices = {"bufferView": index, "componentType": buffers.accessors[index]["componentType"]}
    buffers.accessors[0]["sparse"] = {"count": 1, "indices": indices, "values": {"bufferView": values}}
    with pytest.raises(SceneError, match=r"accessors\[0\]\.sparse\.indices: expected places below 4"):
        Gltf.read(write_gltf(tmp_path / "a.gltf", buffers)).numbers(0)


def test_no_room_is_made_for_zeros_without_end(tmp_path: Path) -> None:
    buffers = Buffers()
    buffers.accessors.append({"componentType": 5126, "count": 10**15, "type": "VEC3"})
    with pytest.raises(SceneError, match=r"accessors\[0\]: expected a count in 0\.\.\d+ without a bufferView"):
        Gltf.read(write_gltf(tmp_path / "a.gltf", buffers)).numbers(0)


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
