from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from svgf_cl_tracer import SceneError
from svgf_cl_tracer.gltf.file import Gltf
from svgf_cl_tracer.gltf.nodes import Nodes
from svgf_cl_tracer.motion import Keyframes
from tests.tracer.gltf_files import Buffers, document, write_gltf

QUARTER_ABOUT_Z = (0, 0, np.sqrt(0.5), np.sqrt(0.5))


def nodes_of(path: Path, buffers: Buffers | None = None, to_world: np.ndarray | None = None, **more: Any) -> Nodes:
    return Nodes(Gltf.read(write_gltf(path / "a.gltf", buffers, **more)), np.eye(4) if to_world is None else to_world)


def moved(nodes: Nodes, chain: tuple[int, ...], time: float = 0.0) -> np.ndarray:
    """Where the node's point (1, 2, 3) is."""
    return (nodes.motion(chain).matrix(time) @ (1, 2, 3, 1))[:3]


def animated(buffers: Buffers, *channels: tuple[int, str, list[float], list[Any]], **more: Any) -> dict[str, Any]:
    """An animation of nodes' paths, each with times and values."""
    return {
        "samplers": [{"input": buffers.add(t, "<f4"), "output": buffers.add(v), **more} for _, _, t, v in channels],
        "channels": [
            {"sampler": index, "target": {"node": node, "path": path}}
            for index, (node, path, _, _) in enumerate(channels)
        ],
    }


def test_parents_come_before_children_in_the_order_of_the_file(tmp_path: Path) -> None:
    nodes = nodes_of(
        tmp_path,
        nodes=[{"name": "a", "children": [2, 3]}, {"name": "b"}, {"name": "c"}, {"children": [4]}, {"name": "e"}],
    )
    assert list(nodes.chains()) == [(0,), (0, 2), (0, 3), (0, 3, 4), (1,)]
    assert nodes.names((0, 3, 4)) == ("a", "", "e")


@pytest.mark.parametrize("children", [[[1], [0]], [[2], [2]], [[0]]])
def test_what_is_no_tree_is_refused(tmp_path: Path, children: list[list[int]]) -> None:
    tree = [{"children": below} for below in children] + [{}]
    nodes = nodes_of(tmp_path, nodes=tree, scenes=[{"nodes": [0, 1]}])
    with pytest.raises(SceneError, match="expected a tree, found node"):
        list(nodes.chains())


@pytest.mark.parametrize("more", [{"scene": 1}, {}])
def test_the_default_scene_is_shown_else_the_first(more: dict[str, int], tmp_path: Path) -> None:
    gltf = document(nodes=[{}, {}, {}], scenes=[{"nodes": [2]}, {"nodes": [1, 0]}]) | more
    del gltf["scene" if not more else "materials"]
    (tmp_path / "a.gltf").write_text(json.dumps(gltf))
    assert list(Nodes(Gltf.read(tmp_path / "a.gltf"), np.eye(4)).chains()) == ([(1,), (0,)] if more else [(2,)])


@pytest.mark.parametrize("scenes", [{}, {"scenes": []}])
def test_without_scenes_all_nodes_are_shown(scenes: dict[str, list[Any]], tmp_path: Path) -> None:
    gltf = document(nodes=[{}, {"children": [0]}, {}])
    del gltf["scenes"], gltf["scene"]
    (tmp_path / "a.gltf").write_text(json.dumps(gltf | scenes))
    assert list(Nodes(Gltf.read(tmp_path / "a.gltf"), np.eye(4)).chains()) == [(1,), (1, 0), (2,)]


def test_a_scene_may_be_empty(tmp_path: Path) -> None:
    assert list(nodes_of(tmp_path, scenes=[{}]).chains()) == []


def test_a_node_has_a_matrix_or_its_parts(tmp_path: Path) -> None:
    nodes = nodes_of(tmp_path, nodes=[{"matrix": np.eye(4).ravel().tolist(), "scale": [1, 1, 1]}])
    with pytest.raises(SceneError, match=r"nodes\[0\]: expected a matrix or translation, rotation, scale, found both"):
        nodes.motion((0,))


def test_transforms_go_from_the_node_outwards_into_the_world(tmp_path: Path) -> None:
    nodes = nodes_of(
        tmp_path,
        to_world=np.diag([10.0, 10.0, 10.0, 1.0]),
        nodes=[
            {"children": [1], "rotation": QUARTER_ABOUT_Z},
            {"translation": [5, 0, 0], "scale": [2, 1, 1]},
        ],
    )
    # (1, 2, 3) is scaled, moved, turned by the parent, and scaled.
    np.testing.assert_allclose(moved(nodes, (0, 1)), (-20, 70, 30), atol=1e-12)


def test_a_matrix_is_stored_by_columns(tmp_path: Path) -> None:
    matrix = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 7, 8, 9, 1]
    np.testing.assert_allclose(moved(nodes_of(tmp_path, nodes=[{"matrix": matrix}]), (0,)), (8, 10, 12))


def test_a_child_moves_with_its_parent(tmp_path: Path) -> None:
    buffers = Buffers()
    animation = animated(
        buffers,
        (0, "rotation", [0, 1], [(0, 0, 0, 1), QUARTER_ABOUT_Z]),
        (1, "translation", [0, 1], [[0, 0, 0], [2, 0, 0]]),
    )
    nodes = nodes_of(tmp_path, buffers, nodes=[{"children": [1]}, {"scale": [1, 1, 2]}, {}], animations=[animation])
    np.testing.assert_allclose(moved(nodes, (0, 1), 0.0), (1, 2, 6), atol=1e-6)
    half = np.sqrt(0.5)
    np.testing.assert_allclose(moved(nodes, (0, 1), 0.5), (0, 4 * half, 6), atol=1e-6)
    for time in (1.0, 5.0):  # and then it stands still
        np.testing.assert_allclose(moved(nodes, (0, 1), time), (-2, 3, 6), atol=1e-6)
    assert not any(isinstance(link, Keyframes) for link in nodes.motion((2,)).links)


def test_a_step_is_one(tmp_path: Path) -> None:
    buffers = Buffers()
    animation = animated(buffers, (0, "translation", [0, 1], [[0, 0, 0], [2, 0, 0]]), interpolation="STEP")
    nodes = nodes_of(tmp_path, buffers, nodes=[{}], animations=[animation])
    np.testing.assert_allclose([moved(nodes, (0,), time)[0] for time in (0, 0.99, 1)], (1, 1, 3))


def test_only_the_first_animation_plays(tmp_path: Path) -> None:
    buffers = Buffers()
    first = animated(buffers, (0, "scale", [0, 1], [[1, 1, 1], [2, 2, 2]]))
    second = animated(buffers, (0, "translation", [0, 1], [[0, 0, 0], [9, 9, 9]]))
    nodes = nodes_of(tmp_path, buffers, nodes=[{}], animations=[first, second])
    np.testing.assert_allclose(moved(nodes, (0,), 1.0), (2, 4, 6))


def test_a_morph_targets_weights_move_nothing(tmp_path: Path) -> None:
    buffers = Buffers()
    nodes = nodes_of(tmp_path, buffers, nodes=[{}], animations=[animated(buffers, (0, "weights", [0, 1], [0, 1]))])
    assert not any(isinstance(link, Keyframes) for link in nodes.motion((0,)).links)


def test_cubic_splines_are_refused_where_something_shows_them(tmp_path: Path) -> None:
    buffers = Buffers()
    animation = animated(buffers, (0, "translation", [0, 1], 6 * [[0, 0, 0]]), interpolation="CUBICSPLINE")
    nodes = nodes_of(tmp_path, buffers, nodes=[{}, {}], animations=[animation])
    nodes.motion((1,))
    with pytest.raises(SceneError, match=r"samplers\[0\]: expected LINEAR or STEP interpolation, found CUBICSPLINE"):
        nodes.motion((0,))


def test_a_matrix_cannot_be_animated(tmp_path: Path) -> None:
    buffers = Buffers()
    animation = animated(buffers, (0, "scale", [0], [[1, 1, 1]]))
    nodes = nodes_of(tmp_path, buffers, nodes=[{"matrix": np.eye(4).ravel().tolist()}], animations=[animation])
    with pytest.raises(SceneError, match=r"nodes\[0\]: expected no matrix"):
        nodes.motion((0,))
