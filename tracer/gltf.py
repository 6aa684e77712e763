"""What trimesh loses of a glTF file's materials: it rounds colours to 8 bits and knows no emissive strength."""

from __future__ import annotations

import json
import struct
from pathlib import Path
from typing import Any

GLB_HEADER = struct.Struct("<4sII")
CHUNK_HEADER = struct.Struct("<I4s")


def read_gltf(path: Path) -> tuple[bytes, list[dict[str, Any]]]:
    """The file with each material renamed to its index, and the materials' own JSON.

    trimesh keeps only the name of the material that a mesh came with: the new names lead back to the JSON.

    Raises
    ------
    ValueError, struct.error
        The file is no glTF.
    """
    data = path.read_bytes()
    binary = data[:4] == b"glTF"
    if binary:
        _, version, _ = GLB_HEADER.unpack_from(data)
        length, kind = CHUNK_HEADER.unpack_from(data, GLB_HEADER.size)
        if kind != b"JSON":
            raise ValueError("the first chunk of the GLB is not JSON")
        start = GLB_HEADER.size + CHUNK_HEADER.size
        data, rest = data[start : start + length], data[start + length :]
    document = json.loads(data)
    materials = document.get("materials", [])
    document["materials"] = [material | {"name": str(index)} for index, material in enumerate(materials)]
    text = json.dumps(document).encode()
    if not binary:
        return text, materials
    text += b" " * (-len(text) % 4)
    total = GLB_HEADER.size + CHUNK_HEADER.size + len(text) + len(rest)
    header = GLB_HEADER.pack(b"glTF", version, total) + CHUNK_HEADER.pack(len(text), b"JSON")
    return header + text + rest, materials
