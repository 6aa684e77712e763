from __future__ import annotations

import json
import struct
from pathlib import Path

import pytest

from tracer.gltf import read_gltf

DOCUMENT = {"asset": {"version": "2.0"}, "materials": [{"name": "same", "emissiveFactor": [1, 0, 0]}, {"name": "same"}]}


def glb(document: dict[str, object], rest: bytes) -> bytes:
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    chunk = struct.pack("<I4s", len(text), b"JSON") + text
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunk) + len(rest)) + chunk + rest


def test_materials_are_named_after_their_index(tmp_path: Path) -> None:
    path = tmp_path / "a.gltf"
    path.write_text(json.dumps(DOCUMENT))
    data, materials = read_gltf(path)
    assert materials == DOCUMENT["materials"]
    assert [material["name"] for material in json.loads(data)["materials"]] == ["0", "1"]


def test_a_binary_file_keeps_its_other_chunks(tmp_path: Path) -> None:
    rest = struct.pack("<I4s", 8, b"BIN\0") + b"12345678"
    path = tmp_path / "a.glb"
    path.write_bytes(glb(DOCUMENT, rest))
    data, materials = read_gltf(path)
    assert materials == DOCUMENT["materials"]
    renamed = DOCUMENT | {"materials": [{"name": "0", "emissiveFactor": [1, 0, 0]}, {"name": "1"}]}
    assert data == glb(renamed, rest)


@pytest.mark.parametrize("data", [b"", b"not json", b"glTF", b"glTF" + bytes(40)])
def test_anything_else_is_refused(tmp_path: Path, data: bytes) -> None:
    path = tmp_path / "a.glb"
    path.write_bytes(data)
    with pytest.raises((ValueError, struct.error)):
        read_gltf(path)
