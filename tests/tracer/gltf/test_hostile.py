"""Files that were made to do harm, or might as well have been: a SceneError in a line, and no room made for them."""

from __future__ import annotations

import copy
import json
import math
import random
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from svgf_cl_tracer import SceneError, load_scene
from svgf_cl_tracer.gltf import model
from svgf_cl_tracer.gltf.file import Gltf
from tests.tracer.gltf_files import Buffers, document, png, uri, write_gltf

SKY = (1.0, 1.0, 1.0)
TEXTURED = {"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}


def refused(path: Path, words: str) -> None:
    """Check that the scene at `path` is refused in one line with these words, a regular expression."""
    with pytest.raises(SceneError, match=words) as caught:
        load_scene(path, SKY)
    assert str(caught.value).startswith(str(path))
    assert "\n" not in str(caught.value)


# Numbers and places


@pytest.mark.parametrize("stride", [0, 1, 11])
def test_rows_that_overlap_are_refused(stride: int, tmp_path: Path) -> None:
    """A stride of 0 would make any number of corners of twelve bytes."""
    buffers = Buffers()
    square = buffers.square()
    buffers.views[0]["byteStride"] = stride
    path = write_gltf(tmp_path / "a.gltf", buffers, meshes=[{"primitives": [square]}])
    refused(path, rf"accessors\[0\]: expected numbers that its buffer holds, found .* byteStride of {stride}")


@pytest.mark.parametrize(
    "change",
    [
        {"count": 10**15},
        {"count": -4},
        {"count": "4"},
        {"byteOffset": -12},
        {"byteOffset": 9999},
        {"componentType": 7},
    ],
    ids=str,
)
def test_numbers_that_the_file_does_not_have_are_refused(change: dict[str, Any], tmp_path: Path) -> None:
    buffers = Buffers()
    square = buffers.square()
    buffers.accessors[0] |= change
    path = write_gltf(tmp_path / "a.gltf", buffers, meshes=[{"primitives": [square]}])
    refused(path, r"accessors\[0\]: expected numbers that its buffer holds")
    with pytest.raises(SceneError, match=r"accessors\[0\]: expected numbers that its buffer holds"):
        Gltf.read(path).numbers(0)


@pytest.mark.parametrize("index", [-1, 10**6, 0.5, "0", None], ids=str)
def test_a_place_that_is_not_there_is_refused(index: Any, tmp_path: Path) -> None:
    """-1, which is Python's word for the last, least of all."""
    buffers = Buffers()
    square = buffers.square()
    light = {"extensions": {"KHR_lights_punctual": {"light": index}}}
    channel = {"sampler": index, "target": {"node": 0, "path": "scale"}}
    broken: dict[str, dict[str, Any]] = {
        "accessors": {"meshes": [{"primitives": [square | {"attributes": {"POSITION": index}}]}]},
        "materials": {"meshes": [{"primitives": [square | {"material": index}]}]},
        "meshes": {"nodes": [{"mesh": index}]},
        "textures": {"materials": [{"emissiveTexture": {"index": index}}]},
        "images": {"textures": [{"source": index}], "materials": [TEXTURED]},
        "bufferViews": {"accessors": [a | {"bufferView": index} for a in buffers.accessors]},
        "buffers": {"bufferViews": [view | {"buffer": index} for view in buffers.views]},
        "nodes": {"scenes": [{"nodes": [index]}]},
        "scenes": {"scene": index},
        "cameras": {"nodes": [{"mesh": 0, "camera": index}], "cameras": [{"type": "perspective"}]},
        "lights": {"nodes": [{"mesh": 0}, light], "scenes": [{"nodes": [0, 1]}]},
        r"animations\[0\]\.samplers": {"animations": [{"samplers": [], "channels": [channel]}]},
    }
    for kind, change in broken.items():
        path = write_gltf(tmp_path / "a.gltf", buffers, **({"meshes": [{"primitives": [square]}]} | change))
        refused(path, rf"{kind}: expected an index from 0 and below \d+, found")


def test_corners_of_another_kind_are_refused(tmp_path: Path) -> None:
    for name in ("POSITION", "NORMAL", "TEXCOORD_0"):
        buffers = Buffers()
        square = buffers.square(normals=True)
        square["attributes"][name] = buffers.add(np.zeros((4, 4)))
        path = write_gltf(tmp_path / "a.gltf", buffers, meshes=[{"primitives": [square]}])
        refused(path, r"accessors\[4\]: expected the type VEC\d, found VEC4")


@pytest.mark.parametrize("name", [1, None, [], {}], ids=str)
def test_a_name_that_is_no_text_is_refused(name: Any, tmp_path: Path) -> None:
    for change in ({"nodes": [{"mesh": 0, "name": name}]}, {"materials": [{"name": name}]}):
        refused(write_gltf(tmp_path / "a.gltf", **change), "name: expected a text, found")


# More than there is room for


def test_nodes_too_deep_are_refused(tmp_path: Path) -> None:
    """What is known of a node grows with its depth: of a file of 1 MB that would be 10 GB."""
    depth = 50_000
    nodes = [{"children": [index + 1]} for index in range(depth)] + [{"mesh": 0}]
    refused(write_gltf(tmp_path / "a.gltf", nodes=nodes), "nodes: expected at most 256 of them below one another")


def test_a_mesh_in_too_many_nodes_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(model, "MAX_TRIANGLES", 20)
    for count in (10, 11):
        path = write_gltf(tmp_path / "a.gltf", nodes=count * [{"mesh": 0}])
        if 2 * count <= 20:
            assert len(load_scene(path, SKY).instances) == count
        else:
            refused(path, "meshes: expected at most 20 triangles in all nodes, found more")


def test_json_nested_too_deeply_is_refused(tmp_path: Path) -> None:
    for name in ("a.gltf", "scene.json"):
        (tmp_path / name).write_text('{"model": ' + "[" * 100_000)
    refused(tmp_path / "a.gltf", "cannot be read as glTF, GLB or OBJ")
    with pytest.raises(SceneError, match=r"scene\.json: .*recursion"):
        load_scene(tmp_path, SKY)


# Files elsewhere


@pytest.fixture
def outside(tmp_path: Path) -> Path:
    """A good image that is none of the model's business, beside its folder."""
    (tmp_path / "inner").mkdir()
    (tmp_path / "outside.png").write_bytes(png(np.full((2, 2, 3), 200)))
    return tmp_path / "outside.png"


def test_an_image_may_lie_beside_the_model_and_nowhere_else(outside: Path) -> None:
    inner = outside.parent / "inner"
    (inner / "inside.png").write_bytes(outside.read_bytes())
    for name, good in {
        "inside.png": True,
        uri(outside.read_bytes(), "image/png"): True,
        "../outside.png": False,
        "x/../../outside.png": False,
        str(outside): False,
        f"file://{outside}": False,
        "http://localhost:1/a.png": False,
        "a\0b.png": False,
        "x" * 5000: False,
        "data:image/png;base64,!": False,
    }.items():
        textures: dict[str, Any] = {"images": [{"uri": name}], "textures": [{"source": 0}], "materials": [TEXTURED]}
        path = write_gltf(inner / "a.gltf", **textures)
        if good:
            assert load_scene(path, SKY).instances[0].material.base_texture is not None
        else:
            refused(path, "the baseColorTexture of material None cannot be read")


def test_an_obj_file_reads_nothing_elsewhere(outside: Path) -> None:
    inner = outside.parent / "inner"
    triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl a\nf 1/1 2/2 3/3\n"
    material = "newmtl a\nKd 0.5 0.5 0.5\nmap_Kd {}\n"
    (inner / "a.obj").write_text("mtllib a.mtl\n" + triangle)
    for name in ("../outside.png", str(outside)):
        (inner / "a.mtl").write_text(material.format(name))
        with pytest.warns(UserWarning, match="images that are not in its folder or below"):
            assert load_scene(inner / "a.obj", SKY).instances[0].material.base_texture is None
    (inner / "inside.png").write_bytes(outside.read_bytes())
    (inner / "a.mtl").write_text(material.format("inside.png"))
    assert load_scene(inner / "a.obj", SKY).instances[0].material.base_texture is not None
    (outside.parent / "b.mtl").write_text(material.format("inner/inside.png"))
    (inner / "a.obj").write_text("mtllib ../b.mtl\n" + triangle)
    with pytest.warns(UserWarning, match=r"material libraries that are not in its folder or below: '\.\./b\.mtl'"):
        assert load_scene(inner / "a.obj", SKY).instances[0].material.base_texture is None


@pytest.mark.parametrize("name", ["../inner/a.gltf", "loop.gltf", "a\0.gltf", "x" * 5000, "/etc/passwd", "", "."])
def test_a_description_names_a_model_in_its_folder(name: str, outside: Path) -> None:
    folder = outside.parent / "described"
    folder.mkdir()
    write_gltf(outside.parent / "inner" / "a.gltf")
    (folder / "loop.gltf").symlink_to("loop.gltf")
    (folder / "scene.json").write_text(json.dumps({"model": name}))
    with pytest.raises(SceneError, match=r"scene\.json: "):
        load_scene(folder, SKY)
    (folder / "scene.json").write_text(json.dumps({"model": "b.gltf", "lights": [{"type": "envmap", "file": name}]}))
    write_gltf(folder / "b.gltf")
    with pytest.raises(SceneError, match=r"scene\.json: "):
        load_scene(folder)


# Anything at all

HOSTILE = [-1, 0, 1, 7, 10**6, 10**12, 2**63, 1e308, math.nan, math.inf, 0.5, "", "x", "\0", "../a", None, True, [], {}]


def everything() -> dict[str, Any]:
    """A document with some of all that is read."""
    buffers = Buffers()
    samplers = [{"input": buffers.add([0.0, 1.0]), "output": buffers.add([[0.0, 0.0, 0.0], [1.0, 1.0, 1.0]])}]
    animation = {"samplers": samplers, "channels": [{"sampler": 0, "target": {"node": 1, "path": "translation"}}]}
    lamp = {"camera": 0, "extensions": {"KHR_lights_punctual": {"light": 0}}}
    return document(
        buffers,
        meshes=[{"primitives": [buffers.square(0, normals=True)]}, {"primitives": [buffers.square(1)]}],
        nodes=[{"mesh": 0, "children": [1], "name": "a"}, {"mesh": 1, "name": "b", "translation": [1, 2, 3]}, lamp],
        materials=[TEXTURED | {"name": "m", "emissiveFactor": [1, 1, 1], "alphaMode": "MASK"}, {}],
        textures=[{"source": 0}],
        images=[{"uri": uri(png(np.ones((2, 2, 3))), "image/png")}],
        cameras=[{"type": "perspective", "perspective": {"yfov": 1.0}}],
        animations=[animation],
        extensions={"KHR_lights_punctual": {"lights": [{"type": "spot", "spot": {}}]}},
    )


def description() -> dict[str, Any]:
    """A description with some of all that is in one."""
    moves = {"kind": "keyframes", "nodes": ["a"], "times_s": [0.0, 1.0], "translation": [[0, 0, 0], [1, 0, 0]]}
    return {
        "model": "a.gltf",
        "camera": [{"position": [0, 0, 3], "look_at": [0, 0, 0]}],
        "lights": [
            {"type": "sky_constant", "radiance": SKY},
            {"type": "area", "material": "m", "radiance": SKY},
        ],
        "materials": {"m": {"type": "plastic", "roughness": 0.5, "base_texture": True}},
        "animation": [moves],
    }


def places(value: Any) -> Iterator[tuple[Any, Any]]:
    """Every place in a JSON value: what holds it, and its index or name there."""
    for key in value if isinstance(value, dict) else range(len(value)) if isinstance(value, list) else ():
        yield value, key
        yield from places(value[key])


@pytest.mark.parametrize("seed", range(4))
def test_whatever_a_file_says_it_is_a_scene_or_refused(seed: int, tmp_path: Path) -> None:
    choice = random.Random(seed)
    refusals = 0
    for _ in range(120):
        files = {"a.gltf": everything(), "scene.json": description()}
        holder, key = choice.choice(list(places(files[choice.choice(["a.gltf", "a.gltf", "scene.json"])])))
        holder[key] = copy.copy(choice.choice(HOSTILE))
        for name, content in files.items():
            (tmp_path / name).write_text(json.dumps(content))
        for path in (tmp_path, tmp_path / "a.gltf"):
            try:
                assert load_scene(path, SKY).instances
            except SceneError as error:
                refusals += 1
                assert "\n" not in str(error)  # noqa: PT017  # either will do
    assert refusals > 60
