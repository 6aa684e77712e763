"""A fingerprint stands for content: the same in another process, another one as soon as anything differs."""

from __future__ import annotations

import os
import pickle
import shutil
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from svgf_cl_tracer import Camera, builtin_scene, fingerprint
from svgf_cl_tracer.fingerprint import tracer_version
from svgf_cl_tracer.geometry import Instance
from svgf_cl_tracer.materials import Material
from svgf_cl_tracer.motion import Motion

CORNERS = np.arange(18.0).reshape(2, 3, 3)
TEXTURE = np.full((4, 4, 3), 7, np.uint8)
OBJECT = Instance(CORNERS, Material(base_texture=TEXTURE), motion=Motion.sliding([0.0, 1.0], [[0, 0, 0], [1, 0, 0]]))

ELSEWHERE = """
from svgf_cl_tracer import builtin_scene
from svgf_cl_tracer.fingerprint import fingerprint, tracer_version
print(fingerprint(builtin_scene().instances), tracer_version())
"""


def test_other_processes_agree() -> None:
    environment = os.environ | {"PYTHONHASHSEED": "12345"}
    said = subprocess.run(
        [sys.executable, "-c", ELSEWHERE], env=environment, capture_output=True, text=True, check=True
    )
    assert said.stdout.split() == [fingerprint.fingerprint(builtin_scene().instances), tracer_version()]


def test_only_content_counts() -> None:
    assert fingerprint.fingerprint(pickle.loads(pickle.dumps(OBJECT))) == fingerprint.fingerprint(OBJECT)
    shared, apart = [TEXTURE, TEXTURE], [TEXTURE, TEXTURE.copy()]
    assert fingerprint.fingerprint(shared) == fingerprint.fingerprint(apart)
    assert fingerprint.fingerprint(CORNERS[:, ::-1]) == fingerprint.fingerprint(CORNERS[:, ::-1].copy())


@pytest.mark.parametrize(
    "change",
    [
        lambda o: replace(o, corners=np.nextafter(o.corners, 99.0)),
        lambda o: replace(o, corners=o.corners.astype(np.float32)),
        lambda o: replace(o, corners=o.corners[::-1]),
        lambda o: replace(o, normals=o.corners),
        lambda o: replace(o, uv=o.corners[..., :2]),
        lambda o: replace(o, motion=None),
        lambda o: replace(o, motion=Motion.sliding([0.0, 1.0], [[0, 0, 0], [1, 0, 0]], repeats=True)),
        lambda o: replace(o, material=replace(o.material, roughness=0.5)),
        lambda o: replace(o, material=replace(o.material, base_texture=TEXTURE.reshape(2, 8, 3))),
        lambda o: replace(o, material=replace(o.material, base_texture=TEXTURE ^ 1)),
        lambda o: (o,),
    ],
)
def test_any_difference_shows(change: Callable[[Instance], Any]) -> None:
    assert fingerprint.fingerprint(change(OBJECT)) != fingerprint.fingerprint(OBJECT)


def test_values_do_not_run_into_each_other() -> None:
    camera = Camera((0, 0, 0), (0, 0, 1))
    different = [(1, 23), (12, 3), ((1,), 23), "123", 123, 123.0, True, 1, None, "None", [], [[]], 0.0, -0.0, camera]
    assert len({fingerprint.fingerprint(each) for each in different}) == len(different)


@pytest.mark.parametrize("unknown", [object(), {"a": 1}, np.array([None]), Camera, [1, {2}]])
def test_what_has_no_content_to_compare_is_refused(unknown: object) -> None:
    with pytest.raises(TypeError, match="expected numbers, texts, arrays"):
        fingerprint.fingerprint(unknown)


def test_another_tracer_has_another_version(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    copy = shutil.copytree(Path(fingerprint.__file__).parent, tmp_path / "tracer")
    monkeypatch.setattr(fingerprint, "__file__", str(copy / "fingerprint.py"))
    assert tracer_version.__wrapped__() == tracer_version()
    (copy / "demo.py").write_text("something else")
    (copy / "cli" / "render.py").write_text("something else")
    assert tracer_version.__wrapped__() == tracer_version()
    (copy / "camera.py").write_text("something else")
    assert tracer_version.__wrapped__() != tracer_version()
