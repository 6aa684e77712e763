from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from svgf_cl_tracer import SceneError
from svgf_cl_tracer.model_file import load_model
from tests.tracer.gltf_files import write_gltf


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(SceneError, match=r"nowhere\.glb: no such file"):
        load_model(tmp_path / "nowhere.glb", np.eye(4))


@pytest.mark.parametrize("name", ["a.glb", "a.gltf", "a.obj", "a.xyzzy", "a.json"])
def test_an_unreadable_file_is_named(tmp_path: Path, name: str) -> None:
    path = tmp_path / name
    path.write_bytes(b"\0\1\2 nothing of the kind")
    with pytest.raises(SceneError, match=name) as caught:
        load_model(path, np.eye(4))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    "material",
    [{"emissiveFactor": [1, 2]}, {"pbrMetallicRoughness": 3}, {"extensions": [1]}, {"emissiveFactor": "red"}],
)
def test_material_without_sense_is_one_line_that_names_the_file(tmp_path: Path, material: dict[str, Any]) -> None:
    path = write_gltf(tmp_path / "a.gltf", materials=[material])
    with pytest.raises(SceneError, match=r"a\.gltf: cannot be read") as caught:
        load_model(path, np.eye(4))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("emission", [[np.nan, 0, 0], [np.inf, 1, 1]])
def test_emission_without_sense_is_refused(tmp_path: Path, emission: list[float]) -> None:
    path = write_gltf(tmp_path / "a.gltf", materials=[{"emissiveFactor": emission}])
    with pytest.raises(SceneError, match=r"a\.gltf: material: expected a finite emission >= 0"):
        load_model(path, np.eye(4))
