from __future__ import annotations

import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from svgf_cl_tracer.gltf import load_gltf
from svgf_cl_tracer.gltf.extensions import INVISIBLE, READ, WITH_FALLBACK
from svgf_cl_tracer.gltf.primitives import MODES
from tests.tracer.gltf_files import CORNERS, Buffers, png, uri, write_gltf

PICTURE = {
    "textures": [{"source": 0}, {"source": 0, "sampler": 0}],
    "images": [{"uri": uri(png(np.zeros((2, 2, 3))), "image/png")}],
}
TEXTURE = {"index": 0}


def lost(folder: Path, buffers: Buffers | None = None, /, **more: Any) -> list[str]:
    """The warnings about a file, each without its name."""
    path = write_gltf(folder / "a.gltf", buffers, **more)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        load_gltf(path, np.eye(4))
    return [str(each.message).removeprefix(f"{path}: ") for each in caught]


def lost_of(folder: Path, material: dict[str, Any], **more: Any) -> list[str]:
    return lost(folder, materials=[material], **PICTURE, **more)


def test_of_a_file_that_is_read_whole_nothing_is_lost(tmp_path: Path) -> None:
    assert lost(tmp_path, extensionsUsed=[*READ, *INVISIBLE, *WITH_FALLBACK]) == []


@pytest.mark.parametrize("listed", [True, False])
def test_extensions_that_are_not_known_are_named(listed: bool, tmp_path: Path) -> None:
    """Whether the file lists them or not."""
    unlit = {"extensions": {"KHR_materials_unlit": {}}, "extras": {"extensions": {"none": {}}}}
    used = {"extensionsUsed": ["KHR_materials_clearcoat"]} if listed else {}
    names = (["KHR_materials_clearcoat"] if listed else []) + ["KHR_materials_unlit"]
    assert lost(tmp_path, materials=[unlit], **used) == [f"extensions that are not read: {', '.join(names)}"]


def test_primitives_of_points_and_lines_are_counted(tmp_path: Path) -> None:
    buffers = Buffers()
    square = buffers.square()
    others = [square | {"mode": mode} for mode in range(4)] + [square | {"mode": 0}, {"attributes": {}}]
    assert lost(tmp_path, buffers, meshes=[{"primitives": [square, *others]}]) == [
        "primitives that are not shown: points (2 times), lines, line loops, line strips, those without POSITION"
    ]


@pytest.mark.parametrize(("mode", "counts"), [(4, (1, 2, 4, 5)), (5, (1, 2)), (6, (1, 2))])
def test_corners_left_over_are_named(mode: int, counts: tuple[int, ...], tmp_path: Path) -> None:
    for count in range(1, 7):
        buffers = Buffers()
        part = {"attributes": {"POSITION": buffers.add(np.ones((count, 3)))}, "mode": mode}
        words = f"primitives that end in corners which make no whole triangle: {MODES[mode]}"
        assert lost(tmp_path, buffers, meshes=[{"primitives": [part]}]) == ([words] if count in counts else [])


@pytest.mark.parametrize(
    ("offset", "size", "named"), [(0, 1, False), (1e4, 1, False), (1e5, 1, True), (-1e7, 1, True), (1e7, 1e4, False)]
)
def test_vertices_far_from_0_that_the_file_rounds_are_named(
    offset: float, size: float, named: bool, tmp_path: Path
) -> None:
    buffers, corners = Buffers(), CORNERS * size + (offset, 0, 0)
    box = {"min": corners.min(0).tolist(), "max": corners.max(0).tolist()}
    part = {"attributes": {"POSITION": buffers.add(corners, **box)}, "mode": 6}
    found = lost(tmp_path, buffers, meshes=[{"primitives": [part]}])
    line = "vertices far from 0, which the file has rounded: a node's translation holds more digits: triangle fans"
    assert found == ([line] if named else [])


def test_morph_targets_and_skins_are_named(tmp_path: Path) -> None:
    buffers = Buffers()
    square = buffers.square() | {"targets": [{"POSITION": buffers.add(CORNERS)}]}
    assert lost(tmp_path, buffers, meshes=[{"primitives": [square]}], nodes=[{"mesh": 0, "skin": 0}]) == [
        "meshes that are shown as they are stored, without: morph targets, skins"
    ]


def test_coordinates_that_are_not_there_are_named(tmp_path: Path) -> None:
    material = {"pbrMetallicRoughness": {"baseColorTexture": TEXTURE | {"texCoord": 1}}}
    assert lost_of(tmp_path, material) == [
        "primitives without the coordinates of their texture, which show one texel of it: TEXCOORD_1"
    ]


@pytest.mark.parametrize(("mode", "columns", "named"), [("MASK", 4, True), ("MASK", 3, False), ("OPAQUE", 4, False)])
def test_opacity_of_vertex_colours_is_named_where_it_matters(
    mode: str, columns: int, named: bool, tmp_path: Path
) -> None:
    buffers = Buffers()
    square = buffers.square()
    square["attributes"]["COLOR_0"] = buffers.add(np.ones((4, columns)))
    found = lost(tmp_path, buffers, meshes=[{"primitives": [square]}], materials=[{"alphaMode": mode}])
    assert found == (["attributes that are read without their opacity: COLOR_0"] if named else [])


def test_parts_of_materials_that_are_not_read_are_named_in_one_line(tmp_path: Path) -> None:
    material = {
        "normalTexture": TEXTURE,
        "occlusionTexture": TEXTURE,
        "extensions": {"KHR_materials_specular": {"specularTexture": TEXTURE}},
    }
    assert lost_of(tmp_path, material) == [
        "parts of materials that are not read: normalTexture, occlusionTexture, specularTexture"
    ]


@pytest.mark.parametrize(
    ("material", "words"),
    [
        ({"alphaMode": "BLEND"}, "alphaMode BLEND"),
        ({"extensions": {"KHR_materials_transmission": {"transmissionFactor": 0.3}}}, "transmissionFactor"),
        ({"pbrMetallicRoughness": {"metallicRoughnessTexture": TEXTURE}}, "metallicRoughnessTexture"),
        (
            {
                "pbrMetallicRoughness": {"baseColorTexture": TEXTURE},
                "emissiveTexture": {"index": 0, "extensions": {"KHR_texture_transform": {"scale": [2, 2]}}},
            },
            "emissiveTexture",
        ),
    ],
)
def test_parts_of_materials_that_are_shown_otherwise_are_named(
    material: dict[str, Any], words: str, tmp_path: Path
) -> None:
    (line,) = lost_of(tmp_path, material)
    assert line.startswith(f"parts of materials that are shown otherwise: {words} (")


@pytest.mark.parametrize(
    ("sampler", "words"),
    [
        ({"wrapS": 33071}, "textures that do not repeat"),
        ({"wrapT": 33648}, "textures that do not repeat"),
        ({"magFilter": 9728}, "magFilter NEAREST"),
        ({"wrapS": 10497, "magFilter": 9729, "minFilter": 9728}, None),
    ],
)
def test_how_textures_are_looked_up_is_named(sampler: dict[str, int], words: str | None, tmp_path: Path) -> None:
    found = lost_of(tmp_path, {"emissiveTexture": {"index": 1}}, samplers=[sampler])
    assert len(found) == (words is not None)
    assert all(words in line for line in found)


def test_materials_that_nothing_shows_are_no_loss(tmp_path: Path) -> None:
    assert lost(tmp_path, materials=[{}, {"alphaMode": "BLEND"}]) == []


PERSPECTIVE = {"type": "perspective", "perspective": {"yfov": 1.0}}
ORTHOGRAPHIC = {"type": "orthographic", "orthographic": {"xmag": 1, "ymag": 1}}


@pytest.mark.parametrize(
    ("cameras", "expected"),
    [
        ([PERSPECTIVE], []),
        ([ORTHOGRAPHIC], []),
        ([PERSPECTIVE, ORTHOGRAPHIC], ["cameras that are not used, as another one comes first: cameras[1]"]),
    ],
)
def test_cameras_that_are_not_used_are_named(
    cameras: list[dict[str, Any]], expected: list[str], tmp_path: Path
) -> None:
    nodes = [{"mesh": 0}, *({"camera": index, "translation": [0, 0, 5]} for index in range(len(cameras)))]
    assert lost(tmp_path, nodes=nodes, cameras=cameras) == expected


def test_animations_that_are_not_played_are_named(tmp_path: Path) -> None:
    buffers = Buffers()
    times, values = buffers.add([0, 1]), buffers.add([[0, 0, 0], [1, 1, 1]])
    channels = [{"sampler": 0, "target": {"node": 1, "path": path}} for path in ("translation", "weights", "pointer")]
    clip = {"samplers": [{"input": times, "output": values}], "channels": channels}
    found = lost(tmp_path, buffers, animations=[clip, clip], nodes=[{"mesh": 0}, {"camera": 0}], cameras=[PERSPECTIVE])
    assert found == [
        "animations that are not played, as another one comes first: animations[1]",
        "channels of the animation that are not read: weights, pointer",
    ]


def test_scenes_and_nodes_that_are_not_shown_are_named(tmp_path: Path) -> None:
    lamp = {"extensions": {"KHR_lights_punctual": {"light": 0}}}
    nodes = [{"mesh": 0}, {"mesh": 0, "name": "ball"}, {"camera": 0}, {}, lamp]
    assert lost(tmp_path, nodes=nodes, cameras=[PERSPECTIVE], scenes=[{"nodes": [1]}, {"nodes": [0]}], scene=1) == [
        "scenes that are not shown: scenes[0]",
        "nodes that are not in the scene shown: 'ball', nodes[2], nodes[4]",
    ]


@pytest.mark.parametrize("mode", [4, 5, 6])
@pytest.mark.parametrize("indexed", [True, False])
def test_as_many_triangles_arrive_as_the_file_has(indexed: bool, mode: int, tmp_path: Path) -> None:
    buffers = Buffers()
    part: dict[str, Any] = {"attributes": {"POSITION": buffers.add(np.ones((12, 3)))}, "mode": mode}
    if indexed:
        part["indices"] = buffers.add(np.arange(12), "<u1")
    path = write_gltf(tmp_path / "a.gltf", buffers, meshes=[{"primitives": [part]}])
    (item,) = load_gltf(path, np.eye(4)).objects
    assert len(item.instance.corners) == (4 if mode == 4 else 10)


def test_the_page_on_scenes_names_all_that_the_code_knows() -> None:
    page = (Path(__file__).parents[3] / "docs" / "scenes.md").read_text()
    for name in sorted(READ | INVISIBLE | WITH_FALLBACK) + list(MODES):
        assert name in page, name
