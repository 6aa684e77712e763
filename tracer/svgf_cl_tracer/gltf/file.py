"""A glTF file: its JSON, and the numbers in its buffers."""

from __future__ import annotations

import json
import struct
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from svgf_cl_tracer.errors import SceneError
from svgf_cl_tracer.vectors import Float64

from .extensions import INVISIBLE, READ
from .resources import resource

GLB_HEADER = struct.Struct("<4sII")
CHUNK_HEADER = struct.Struct("<I4s")

Thing = TypeVar("Thing")

COMPONENTS = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
COLUMNS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}

# An accessor may have zeros that are not in the file, so a few bytes may stand for any number of them.
MAX_ZEROS = 2**22


@dataclass(frozen=True, eq=False)
class Gltf:
    """A glTF 2.0 file, text or binary.

    Parameters
    ----------
    path : Path
    document : dict
        Its JSON.
    binary : bytes, optional
        The buffer that follows the JSON in a binary file.
    """

    path: Path
    document: dict[str, Any]
    binary: bytes | None = None
    _buffers: dict[int, bytes] = field(default_factory=dict, init=False, repr=False)

    @classmethod
    def read(cls, path: Path) -> Gltf:
        """Read the file at `path`.

        Raises
        ------
        SceneError
            If it has another version, or needs an extension that is not known here.
        ValueError, struct.error
            If it is not a glTF file.
        """
        data, binary = path.read_bytes(), None
        if data[:4] == b"glTF":
            chunks = _chunks(data)
            if b"JSON" not in chunks:
                raise ValueError("the GLB has no chunk of JSON")
            data, binary = chunks[b"JSON"], chunks.get(b"BIN\0")
        document = json.loads(data)
        version = document.get("asset", {}).get("version", "2.0")
        if not str(version).startswith("2."):
            raise SceneError(f"asset.version: expected glTF 2.0, found {version!r}; export the model as glTF 2.0")
        known = READ | INVISIBLE
        unknown = sorted(set(document.get("extensionsRequired", [])) - known)
        if unknown:
            raise SceneError(f"extensionsRequired: expected none but {', '.join(sorted(known))}, found {unknown}")
        return cls(path, document, binary)

    def item(self, kind: str, index: Any) -> dict[str, Any]:
        """The JSON object at `index` of the list `kind`, such as ``"nodes"``; `SceneError` if there is none."""
        return entry(self.document.get(kind, []), kind, index)

    def numbers(self, accessor: int) -> Float64:
        """The values (n, components) of an accessor; normalized integers are converted to fractions.

        Raises
        ------
        SceneError
            If the file does not contain them.
        """
        values = self.values(accessor)
        numbers: Float64 = values.astype(np.float64)
        if self.item("accessors", accessor).get("normalized") and values.dtype.kind in "iu":
            numbers = np.maximum(numbers / np.iinfo(values.dtype).max, -1.0)
        return numbers

    def values(self, accessor: int) -> NDArray[Any]:
        """The values (n, components) of an accessor as they are stored.

        `SceneError` if the file does not contain them.
        """
        layout, where = self.item("accessors", accessor), f"accessors[{accessor}]"
        values: NDArray[Any]
        if "bufferView" in layout:
            values = self._block(where, layout)
        elif isinstance(count := layout.get("count"), int) and 0 <= count <= MAX_ZEROS:
            values = np.zeros((count, COLUMNS[layout["type"]]), COMPONENTS[layout["componentType"]])
        else:
            raise SceneError(f"{where}: expected a count in 0..{MAX_ZEROS} without a bufferView, found {count!r}")
        return self._replaced(where, values, layout) if "sparse" in layout else values

    def view(self, index: Any) -> memoryview:
        """The bytes of a buffer view; `SceneError` if the file does not contain them."""
        view = self.item("bufferViews", index)
        buffer, start, length = self._buffer(view.get("buffer")), view.get("byteOffset", 0), view.get("byteLength")
        if not (isinstance(start, int) and isinstance(length, int) and 0 <= start <= start + length <= len(buffer)):
            raise SceneError(
                f"bufferViews[{index}]: expected bytes that its buffer holds, found {length!r} at {start!r}"
            )
        return memoryview(buffer)[start : start + length]

    def _replaced(self, where: str, values: NDArray[Any], layout: dict[str, Any]) -> NDArray[Any]:
        """`values`, with those replaced that a sparse accessor lists."""
        sparse = layout["sparse"]
        result: NDArray[Any] = values.copy()
        size = {"count": sparse["count"]}
        rows = self._block(f"{where}.sparse.indices", sparse["indices"] | size | {"type": "SCALAR"})[:, 0]
        if rows.dtype.kind != "u" or (rows >= len(result)).any():
            raise SceneError(f"{where}.sparse.indices: expected places below {len(result)}, found others")
        alike = {"type": layout["type"], "componentType": layout["componentType"]}
        result[rows] = self._block(f"{where}.sparse.values", sparse["values"] | size | alike)
        return result

    def _block(self, where: str, layout: dict[str, Any]) -> NDArray[Any]:
        """Numbers (count, components) in a buffer view, as described by `layout`."""
        view = self.item("bufferViews", layout["bufferView"])
        buffer = self._buffer(view.get("buffer"))
        try:
            kind, columns = np.dtype(COMPONENTS[layout["componentType"]]), COLUMNS[layout["type"]]
            row = columns * kind.itemsize
            start, stride = view.get("byteOffset", 0) + layout.get("byteOffset", 0), view.get("byteStride", row)
            if stride < row:  # rows that overlap, so that a few bytes would give any number of rows
                raise ValueError(f"a byteStride of {stride}")
            # Raises an error if the buffer is too short.
            shape, strides = (layout["count"], columns), (stride, kind.itemsize)
            values: NDArray[Any] = np.ndarray(shape, kind, buffer, start, strides)
        except (KeyError, TypeError, ValueError) as error:
            raise SceneError(f"{where}: expected numbers that its buffer holds, found others ({error})") from error
        return values

    def _buffer(self, index: Any) -> bytes:
        uri = self.item("buffers", index).get("uri")
        if uri is None and index == 0 and self.binary is not None:
            return self.binary
        if uri is None:
            raise SceneError(f"buffers[{index}]: expected a uri, found none")
        if index not in self._buffers:
            try:
                self._buffers[index] = resource(self.path.parent, uri)
            except SceneError as error:
                raise SceneError(f"buffers[{index}].uri: {error}") from error
        return self._buffers[index]


def _chunks(data: bytes) -> dict[bytes, bytes]:
    """The chunks of a binary file by kind, the first one of each; `struct.error` if a chunk is truncated."""
    found: dict[bytes, bytes] = {}
    start = GLB_HEADER.size
    while start < len(data):
        length, kind = CHUNK_HEADER.unpack_from(data, start)
        start += CHUNK_HEADER.size
        found.setdefault(kind, data[start : start + length])
        start += length
    return found


def entry(things: Sequence[Thing], kind: str, index: Any) -> Thing:
    """The element of `things` with the `index` that a file gives.

    Raises
    ------
    SceneError
        If there is none, or the index is negative, which files do not allow.
    """
    if not isinstance(index, int) or not 0 <= index < len(things):
        raise SceneError(f"{kind}: expected an index from 0 and below {len(things)}, found {index!r}")
    return things[index]


def name_of(document: dict[str, Any]) -> str:
    """The name of a node or material, empty if it has none; `SceneError` if the name is not text."""
    name = document.get("name", "")
    if not isinstance(name, str):
        raise SceneError(f"name: expected a text, found {name!r}")
    return name
