"""glTF files made for tests."""

from __future__ import annotations

import base64
import io
import json
import struct
from pathlib import Path
from typing import Any

import numpy as np
import PIL.Image
from numpy.typing import ArrayLike

KINDS = {"<i1": 5120, "<u1": 5121, "<i2": 5122, "<u2": 5123, "<u4": 5125, "<f4": 5126}
SHAPES = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4"}

# A unit square in the plane z = 0 whose front and top are +z and +y; v points down, as glTF has it.
CORNERS = np.array([(-0.5, 0.5, 0), (-0.5, -0.5, 0), (0.5, -0.5, 0), (0.5, 0.5, 0)])
TEXCOORDS = np.array([(0, 0), (0, 1), (1, 1), (1, 0)])
# These lean towards +x and +y.
NORMAL = (0.48, 0.36, 0.8)


def uri(data: bytes, kind: str = "application/octet-stream") -> str:
    return f"data:{kind};base64,{base64.b64encode(data).decode()}"


def png(pixels: ArrayLike) -> bytes:
    stream = io.BytesIO()
    PIL.Image.fromarray(np.asarray(pixels, np.uint8)).save(stream, "png")
    return stream.getvalue()


class Buffers:
    """The numbers of a file, each block of them an accessor."""

    def __init__(self) -> None:
        self.data = b""
        self.views: list[dict[str, Any]] = []
        self.accessors: list[dict[str, Any]] = []

    def add(self, values: ArrayLike, kind: str = "<f4", **more: Any) -> int:
        """Add (n, columns) `values`; the accessor's index."""
        array = np.asarray(values, kind)
        array = array.reshape(len(array), -1)
        self.views.append({"buffer": 0, "byteOffset": len(self.data), "byteLength": array.nbytes})
        self.data += array.tobytes() + bytes(-array.nbytes % 4)
        accessor = {"bufferView": len(self.views) - 1, "componentType": KINDS[kind], "count": len(array)}
        self.accessors.append(accessor | {"type": SHAPES[array.shape[1]]} | more)
        return len(self.accessors) - 1

    def square(self, material: int | None = 0, *, normals: bool = False) -> dict[str, Any]:
        """Add the square; a primitive that shows it."""
        attributes = {"POSITION": self.add(CORNERS), "TEXCOORD_0": self.add(TEXCOORDS)}
        if normals:
            attributes["NORMAL"] = self.add(4 * [NORMAL])
        indices = self.add([0, 1, 2, 0, 2, 3], "<u4")
        return {"attributes": attributes, "indices": indices} | ({} if material is None else {"material": material})


def document(buffers: Buffers | None = None, /, **more: Any) -> dict[str, Any]:
    """A document with one square mesh in one node at rest, unless `more` says otherwise."""
    buffers = buffers or Buffers()
    meshes = more.get("meshes") or [{"primitives": [buffers.square()]}]
    nodes = more.get("nodes") or [{"mesh": 0}]
    below = {child for node in nodes for child in node.get("children", [])}
    return {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [index for index in range(len(nodes)) if index not in below]}],
        "nodes": nodes,
        "meshes": meshes,
        "materials": [{}],
        "accessors": buffers.accessors,
        "bufferViews": buffers.views,
        "buffers": [{"uri": uri(buffers.data), "byteLength": len(buffers.data)}],
    } | more


def write_gltf(path: Path, buffers: Buffers | None = None, /, **more: Any) -> Path:
    """Write `document` of these as a .gltf file."""
    path.write_text(json.dumps(document(buffers, **more)))
    return path


def glb(document: dict[str, Any], binary: bytes) -> bytes:
    """A binary file of `document` and a chunk of numbers."""
    chunks = b""
    for kind, data, pad in ((b"JSON", json.dumps(document).encode(), b" "), (b"BIN\0", binary, b"\0")):
        data += pad * (-len(data) % 4)
        chunks += struct.pack("<I4s", len(data), kind) + data
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks
