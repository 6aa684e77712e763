from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from svgf_cl_tracer import SceneError
from svgf_cl_tracer.gltf import load_gltf
from svgf_cl_tracer.gltf.file import Gltf
from svgf_cl_tracer.gltf.instancing import places
from tests.tracer.gltf_files import CORNERS, Buffers, write_gltf

QUARTER_ABOUT_Z = (0, 0, np.sqrt(0.5), np.sqrt(0.5))


def instances(**attributes: int) -> dict[str, Any]:
    return {"extensions": {"EXT_mesh_gpu_instancing": {"attributes": attributes}}}


def test_a_node_without_instances_shows_its_mesh_once_where_it_is(tmp_path: Path) -> None:
    (place,) = places(Gltf.read(write_gltf(tmp_path / "a.gltf")), {})
    np.testing.assert_array_equal(place, np.eye(4))


def test_each_is_scaled_turned_and_moved_within_its_node(tmp_path: Path) -> None:
    buffers = Buffers()
    node = {"mesh": 0, "scale": [10, 10, 10], "name": "wood"} | instances(
        TRANSLATION=buffers.add([[1, 0, 0], [2, 0, 0]]),
        ROTATION=buffers.add([(0, 0, 0, 1), QUARTER_ABOUT_Z]),
        SCALE=buffers.add([[1, 1, 1], [3, 1, 1]]),
        _CUSTOM=99,
    )
    model = load_gltf(write_gltf(tmp_path / "a.gltf", buffers, nodes=[node]), np.eye(4))
    first, second = (item.instance.corners[0] for item in model.objects)
    np.testing.assert_allclose(first, 10 * np.add(CORNERS[:3], (1, 0, 0)), atol=1e-5)
    x, y, z = CORNERS[:3].T
    np.testing.assert_allclose(second, 10 * np.stack([2 - y, 3 * x, z], axis=1), atol=1e-5)
    assert [item.nodes for item in model.objects] == [("wood",), ("wood",)]


def test_rotations_may_be_integers_that_stand_for_fractions(tmp_path: Path) -> None:
    buffers = Buffers()
    node = instances(ROTATION=buffers.add([(0, 0, 127, 0)], "<i1", normalized=True))
    (place,) = places(Gltf.read(write_gltf(tmp_path / "a.gltf", buffers)), node)
    np.testing.assert_allclose(place, np.diag([-1, -1, 1, 1]), atol=1e-12)


@pytest.mark.parametrize("counts", [(1, 2), ()])
def test_attributes_are_as_many_as_one_another(counts: tuple[int, ...], tmp_path: Path) -> None:
    buffers = Buffers()
    node = instances(
        **{n: buffers.add(np.ones((c, 3))) for n, c in zip(("TRANSLATION", "SCALE"), counts, strict=False)}
    )
    with pytest.raises(SceneError, match="EXT_mesh_gpu_instancing: expected as many of each"):
        places(Gltf.read(write_gltf(tmp_path / "a.gltf", buffers)), node)


def test_attributes_of_another_type_are_refused(tmp_path: Path) -> None:
    buffers = Buffers()
    node = instances(SCALE=buffers.add(np.ones((2, 4))))
    with pytest.raises(SceneError, match=r"accessors\[0\]: expected the type VEC3, found 4 numbers each"):
        places(Gltf.read(write_gltf(tmp_path / "a.gltf", buffers)), node)
