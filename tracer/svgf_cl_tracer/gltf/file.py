"""The file itself: its JSON, the numbers in its buffers, and its meshes as trimesh decodes them."""

from __future__ import annotations

import base64
import io
import json
import struct
from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
import trimesh
from numpy.typing import NDArray
from trimesh.resolvers import FilePathResolver

from svgf_cl_tracer.errors import SceneError
from svgf_cl_tracer.vectors import Float64

GLB_HEADER = struct.Struct("<4sII")
CHUNK_HEADER = struct.Struct("<I4s")

Thing = TypeVar("Thing")

COMPONENTS = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
COLUMNS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}

# What the accessors of a mesh hold that are read.
ATTRIBUTES = {"POSITION": "VEC3", "NORMAL": "VEC3", "TEXCOORD_0": "VEC2"}

# Those without which a file cannot be shown and yet can be shown here.
EXTENSIONS = {
    "KHR_lights_punctual",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_specular",
    "KHR_materials_transmission",
}


@dataclass(frozen=True, eq=False)
class Gltf:
    """A glTF 2.0 file, text or binary.

    Parameters
    ----------
    path : Path
    document : dict
        Its JSON.
    chunks : bytes, optional
        What follows the JSON in a binary file.
    """

    path: Path
    document: dict[str, Any]
    chunks: bytes | None = None

    @classmethod
    def read(cls, path: Path) -> Gltf:
        """Read the file at `path`.

        Raises
        ------
        SceneError
            It needs an extension that is not known here.
        ValueError, struct.error
            It is no glTF.
        """
        data, chunks = path.read_bytes(), None
        if data[:4] == b"glTF":
            length, kind = CHUNK_HEADER.unpack_from(data, GLB_HEADER.size)
            if kind != b"JSON":
                raise ValueError("the first chunk of the GLB is not JSON")
            start = GLB_HEADER.size + CHUNK_HEADER.size
            data, chunks = data[start : start + length], data[start + length :]
        document = json.loads(data)
        unknown = sorted(set(document.get("extensionsRequired", [])) - EXTENSIONS)
        if unknown:
            raise SceneError(f"extensionsRequired: expected none but {', '.join(sorted(EXTENSIONS))}, found {unknown}")
        return cls(path, document, chunks)

    def item(self, kind: str, index: Any) -> dict[str, Any]:
        """The JSON object at `index` of the list `kind`, such as ``"nodes"``; `SceneError` where there is none."""
        return entry(self.document.get(kind, []), kind, index)

    def numbers(self, accessor: int) -> Float64:
        """The values (n, components) of an accessor; integers that stand for fractions are turned into these.

        Raises
        ------
        SceneError
            They are sparse or compressed, or the file does not have them.
        """
        values = self._values(accessor)
        numbers: Float64 = values.astype(np.float64)
        if self.item("accessors", accessor).get("normalized"):
            numbers = np.maximum(numbers / np.iinfo(values.dtype).max, -1.0)
        return numbers

    def meshes(self) -> dict[int, list[trimesh.Trimesh]]:
        """The triangles of each mesh by its index, one `Trimesh` a primitive; materials are called by their index.

        Raises
        ------
        SceneError
            Some are sparse or compressed, or the file does not have them.
        """
        for mesh in self.document.get("meshes", []):
            for accessor, kind in _accessors_read(mesh):
                found = self.item("accessors", accessor).get("type")
                if found != kind:
                    raise SceneError(f"accessors[{accessor}]: expected the type {kind}, found {found}")
                self._values(accessor)
        stream, kind = io.BytesIO(self._for_trimesh()), "gltf" if self.chunks is None else "glb"
        loaded = trimesh.load_scene(stream, file_type=kind, resolver=FilePathResolver(str(self.path)))
        found = defaultdict(list)
        for geometry in loaded.geometry.values():
            if isinstance(geometry, trimesh.Trimesh):
                found[geometry.metadata["mesh"]].append(geometry)
        return found

    def _for_trimesh(self) -> bytes:
        """The file without all that is read here, and with names that lead from what trimesh makes back to the JSON."""
        aside = ("nodes", "scenes", "scene", "cameras", "animations", "skins")
        document = {key: value for key, value in self.document.items() if key not in aside}
        document["materials"] = [m | {"name": str(n)} for n, m in enumerate(document.get("materials", []))]
        document["meshes"] = [m | {"extras": {"mesh": n}} for n, m in enumerate(document.get("meshes", []))]
        # trimesh makes room for numbers that no buffer holds, however many the file claims.
        document["accessors"] = [self._or_empty(index) for index in range(len(document.get("accessors", [])))]
        text = json.dumps(document).encode()
        if self.chunks is None:
            return text
        text += b" " * (-len(text) % 4)
        total = GLB_HEADER.size + CHUNK_HEADER.size + len(text) + len(self.chunks)
        return GLB_HEADER.pack(b"glTF", 2, total) + CHUNK_HEADER.pack(len(text), b"JSON") + text + self.chunks

    def _or_empty(self, accessor: int) -> dict[str, Any]:
        """The JSON of an accessor; of one that cannot be read, and that no triangle needs, that of an empty one."""
        layout = self.item("accessors", accessor)
        try:
            self._values(accessor)
        except SceneError:
            return {"componentType": 5126, "type": layout.get("type"), "count": 0}
        return layout

    def _values(self, accessor: int) -> NDArray[Any]:
        """The values (n, components) of an accessor as the file has them."""
        layout, where = self.item("accessors", accessor), f"accessors[{accessor}]"
        if not _plain(layout):
            raise SceneError(f"{where}: expected plain data, found sparse or compressed data")
        view = self.item("bufferViews", layout["bufferView"])
        buffer = entry(self._buffers, "buffers", view.get("buffer"))
        try:
            kind, columns = np.dtype(COMPONENTS[layout["componentType"]]), COLUMNS[layout["type"]]
            row = columns * kind.itemsize
            start, stride = view.get("byteOffset", 0) + layout.get("byteOffset", 0), view.get("byteStride", row)
            if stride < row:  # rows that overlap: a few bytes would stand for any number of them
                raise ValueError(f"a byteStride of {stride}")
            # Raises where the buffer is too short.
            shape, strides = (layout["count"], columns), (stride, kind.itemsize)
            values: NDArray[Any] = np.ndarray(shape, kind, buffer, start, strides)
        except (KeyError, TypeError, ValueError) as error:
            raise SceneError(f"{where}: expected numbers that its buffer holds, found others ({error})") from error
        return values

    @cached_property
    def _buffers(self) -> list[bytes]:
        return [self._buffer(buffer.get("uri")) for buffer in self.document["buffers"]]

    def _buffer(self, uri: str | None) -> bytes:
        if uri is None:
            chunks = self.chunks or b""
            length, _ = CHUNK_HEADER.unpack_from(chunks)
            return chunks[CHUNK_HEADER.size : CHUNK_HEADER.size + length]
        if uri.startswith("data:"):
            return base64.b64decode(uri.partition("base64,")[2])
        data: bytes = FilePathResolver(str(self.path)).get(uri)  # refuses what is not beside the file
        return data


def _plain(accessor: dict[str, Any]) -> bool:
    return "bufferView" in accessor and "sparse" not in accessor


def _accessors_read(mesh: dict[str, Any]) -> Iterator[tuple[int, str]]:
    """The accessors that make the triangles of a mesh, and of what type they must be."""
    for primitive in mesh["primitives"]:
        attributes = primitive["attributes"]
        yield from ((attributes[name], kind) for name, kind in ATTRIBUTES.items() if name in attributes)
        if "indices" in primitive:
            yield primitive["indices"], "SCALAR"


def entry(things: Sequence[Thing], kind: str, index: Any) -> Thing:
    """The one of `things` that a file names by `index`.

    Raises
    ------
    SceneError
        There is none, or it is named from the end, as files cannot.
    """
    if not isinstance(index, int) or not 0 <= index < len(things):
        raise SceneError(f"{kind}: expected an index from 0 and below {len(things)}, found {index!r}")
    return things[index]


def name_of(document: dict[str, Any]) -> str:
    """What a node or material is called, if anything; `SceneError` where that is no text."""
    name = document.get("name", "")
    if not isinstance(name, str):
        raise SceneError(f"name: expected a text, found {name!r}")
    return name
