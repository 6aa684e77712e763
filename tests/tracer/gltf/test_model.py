from __future__ import annotations

from pathlib import Path

import numpy as np

from svgf_cl_tracer.gltf import load_gltf
from tests.tracer.gltf_files import CORNERS, Buffers, write_gltf

FACES = [[0, 1, 2], [0, 2, 3]]


def test_what_does_not_move_lies_in_the_world(tmp_path: Path) -> None:
    nodes = [{"name": "a", "children": [1], "translation": [1, 0, 0]}, {"name": "b", "mesh": 0, "scale": [2, 2, 2]}]
    (item,) = load_gltf(write_gltf(tmp_path / "a.gltf", nodes=nodes), np.diag([10.0, 10.0, 10.0, 1.0])).objects
    np.testing.assert_allclose(item.instance.corners, 10 * (CORNERS[FACES] * 2 + (1, 0, 0)))
    assert item.instance.motion is None
    assert item.nodes == ("a", "b")


def test_what_hangs_on_something_that_moves_lies_in_its_own_frame(tmp_path: Path) -> None:
    buffers = Buffers()
    sampler = {"input": buffers.add([0, 1]), "output": buffers.add([[0, 0, 0], [0, 4, 0]])}
    animation = {"samplers": [sampler], "channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}]}
    nodes = [{"children": [1]}, {"mesh": 0, "scale": [2, 2, 2]}, {"mesh": 0}]
    model = load_gltf(write_gltf(tmp_path / "a.gltf", buffers, nodes=nodes, animations=[animation]), np.eye(4))
    child, other = (item.instance for item in model.objects)
    np.testing.assert_allclose(child.corners, CORNERS[FACES])
    np.testing.assert_allclose(child.motion.matrix(0.5), [[2, 0, 0, 0], [0, 2, 0, 2], [0, 0, 2, 0], [0, 0, 0, 1]])
    assert other.motion is None


def test_every_primitive_of_every_node_is_an_object_and_materials_are_shared(tmp_path: Path) -> None:
    buffers = Buffers()
    meshes = [{"primitives": [buffers.square(0), buffers.square(1), buffers.square(None)]}]
    materials = [
        {"name": "wood"},
        {"name": "gone", "alphaMode": "BLEND", "pbrMetallicRoughness": {"baseColorFactor": 4 * [0]}},
    ]
    nodes = [{"mesh": 0}, {"mesh": 0}]
    path = write_gltf(tmp_path / "a.gltf", buffers, meshes=meshes, materials=materials, nodes=nodes)
    objects = load_gltf(path, np.eye(4)).objects
    assert [item.material for item in objects] == ["wood", "", "wood", ""]
    assert objects[0].instance.material is objects[2].instance.material


def test_a_skin_and_morph_targets_are_shown_as_stored(tmp_path: Path) -> None:
    buffers = Buffers()
    square = buffers.square() | {"targets": [{"POSITION": buffers.add(CORNERS + 1)}]}
    nodes = [{"mesh": 0, "skin": 0}, {"name": "joint", "translation": [9, 9, 9]}]
    meshes = [{"primitives": [square], "weights": [1]}]
    path = write_gltf(tmp_path / "a.gltf", buffers, nodes=nodes, meshes=meshes, skins=[{"joints": [1]}])
    (item,) = load_gltf(path, np.eye(4)).objects
    np.testing.assert_allclose(item.instance.corners, CORNERS[FACES])
