from __future__ import annotations

import io
import math
from pathlib import Path
from typing import Any

import numpy as np
import PIL.Image
import pytest

from svgf_cl_tracer import SceneError
from svgf_cl_tracer.gltf.file import Gltf
from svgf_cl_tracer.gltf.textures import Coordinates, Textures
from tests.tracer.gltf_files import Buffers, png, uri, write_gltf

PIXELS = np.arange(24, dtype=np.uint8).reshape(2, 4, 3) * 10


def transform(**values: Any) -> dict[str, Any]:
    return {"index": 0, "extensions": {"KHR_texture_transform": values}}


def moved(uv: tuple[float, float], **values: Any) -> list[float]:
    """Where a transform moves a point of the file; v points down on both sides."""
    u, v = Coordinates.of(transform(**values)).applied(np.array([uv], float))[0]
    return [u, 1 - v]


def test_coordinates_are_turned_upright() -> None:
    np.testing.assert_array_equal(Coordinates().applied(np.array([[0.25, 0.25], [2, -1]])), [[0.25, 0.75], [2, 2]])


def test_the_set_is_named_by_the_texture_and_the_transform_before_it() -> None:
    assert Coordinates.of({"index": 0}).attribute == "TEXCOORD_0"
    assert Coordinates.of({"index": 0, "texCoord": 1}).attribute == "TEXCOORD_1"
    assert Coordinates.of(transform(texCoord=2) | {"texCoord": 1}).attribute == "TEXCOORD_2"


def test_a_transform_scales_turns_and_moves() -> None:
    np.testing.assert_allclose(moved((0.5, 0.25), scale=[2, 4]), (1, 1))
    np.testing.assert_allclose(moved((0.5, 0.25), offset=[0.1, 0.2]), (0.6, 0.45))
    np.testing.assert_allclose(moved((0.5, 0.25), offset=[0, 1], scale=[1, -1]), (0.5, 0.75))


def test_the_example_of_the_specification() -> None:
    """The image's lower left quarter, turned clockwise: its upper left corner comes to the upper right."""
    values = {"offset": [0, 1], "rotation": math.pi / 2, "scale": [0.5, 0.5]}
    np.testing.assert_allclose(moved((0, 0), **values), (0, 1), atol=1e-12)
    np.testing.assert_allclose(moved((1, 0), **values), (0, 0.5), atol=1e-12)
    np.testing.assert_allclose(moved((1, 1), **values), (0.5, 0.5), atol=1e-12)


def textures(folder: Path, texture: dict[str, Any], image: dict[str, Any], buffers: Buffers | None = None) -> Textures:
    path = write_gltf(folder / "a.gltf", buffers, textures=[texture], images=[{"uri": "none.png"}, image])
    return Textures(Gltf.read(path))


def test_an_image_lies_beside_in_the_uri_or_in_a_buffer(tmp_path: Path) -> None:
    (tmp_path / "my image.png").write_bytes(png(PIXELS))
    buffers = Buffers()
    view = buffers.accessors[buffers.add(np.frombuffer(png(PIXELS), np.uint8), "<u1")]["bufferView"]
    for image in ({"uri": "my%20image.png"}, {"uri": uri(png(PIXELS), "image/png")}, {"bufferView": view}):
        found = textures(tmp_path, {"source": 1}, image, buffers).pixels({"index": 0})
        np.testing.assert_array_equal(found, PIXELS)


def test_webp_has_an_extension_of_its_own(tmp_path: Path) -> None:
    stream = io.BytesIO()
    PIL.Image.fromarray(PIXELS).save(stream, "webp", lossless=True)
    image = {"uri": uri(stream.getvalue(), "image/webp")}
    texture = {"source": 0, "extensions": {"EXT_texture_webp": {"source": 1}}}
    np.testing.assert_array_equal(textures(tmp_path, texture, image).pixels({"index": 0}), PIXELS)


def test_an_image_of_a_kind_that_is_not_read_is_named(tmp_path: Path) -> None:
    texture = {"extensions": {"KHR_texture_basisu": {"source": 1}}}
    with pytest.raises(SceneError, match=r"textures\[0\]: expected the source of an image, found KHR_texture_basisu"):
        textures(tmp_path, texture, {}).pixels({"index": 0})


@pytest.mark.parametrize("length", [None, -1, 10**9, "1"])
def test_an_image_outside_its_buffer_is_refused(length: Any, tmp_path: Path) -> None:
    buffers = Buffers()
    buffers.views.append({"buffer": 0, "byteLength": length})
    with pytest.raises(SceneError, match=r"bufferViews\[0\]: expected bytes that its buffer holds"):
        textures(tmp_path, {"source": 1}, {"bufferView": 0}, buffers).pixels({"index": 0})
