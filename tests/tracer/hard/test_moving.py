"""Things that move, mirrored, flat or without size at times: each moment is the still picture of what is there."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from svgf_cl import Frame
from svgf_cl_tracer import Camera, CameraPath, Scene, Shot, load_scene, render_frame
from svgf_cl_tracer.geometry import Instance
from svgf_cl_tracer.materials import Material
from svgf_cl_tracer.motion import Keyframes, Motion, Track
from tests.tracer.gltf_files import Buffers, write_gltf

Quad = Callable[..., Instance]

CASES = Path(__file__).parents[4] / "shared" / "cases" / "gltf"

FRONT = CameraPath.static(Camera((0, 0, 2), (0, 0, 0), fov_y=30.0))
SHAPE = (16, 16)
WHITE = (1.0, 1.0, 1.0)

# From time 0 to 1: what the axes of a thing are multiplied by.
SIZES = {
    "grown from nothing": [(0, 0, 0), (1, 1, 1)],
    "flat at first": [(1, 1, 0), (1, 1, 1)],
    "flat later": [(1, 1, 1), (1, 1, 0)],
    "mirrored later": [(1, 1, 1), (-1, 1, 1)],
    "mirrored at first": [(1, -1, 1), (1, 1, 1)],
    "turned inside out": [(1, 1, 1), (-1, -1, -1)],
    "tiny at first": [(1e-9, 1e-9, -1e-9), (1, 1, 1)],
}


def resized(name: str) -> Keyframes:
    return Keyframes(scale=Track([0.0, 1.0], SIZES[name]))


def pictures(scene: Scene, number: int = 0) -> Frame:
    return render_frame(Shot(scene, SHAPE, 25, FRONT), number, spp=4)


@pytest.mark.parametrize("time", [0.0, 0.25, 0.5, 0.75, 1.0])
@pytest.mark.parametrize("size", SIZES)
def test_a_moment_is_the_still_picture_of_it(quad: Quad, size: str, time: float) -> None:
    turn = Motion.turning((0, 0, 0), (1, 2, 3), [0.0, 1.0], [0.0, 25.0])
    lamp, glass = Material(emission=WHITE), Material((1.0, 0.5, 0.25), transmissive=True)
    parts = [
        quad((-0.4, -0.2, 0.1), (0.4, 0, 0), (0, 0.4, 0), lamp, Motion([*turn.links, resized(size)])),
        quad((0.1, -0.2, 0.1), (0.3, 0, 0), (0, 0.4, 0), glass, Motion([resized(size), *turn.links])),
        quad((-1, -1, -0.5), (2, 0, 0), (0, 2, 0), Material((0.5, 0.6, 0.7))),
    ]
    moving = pictures(Scene(parts, sky=(0.1, 0.1, 0.1)), int(24 * time))
    still = [replace(part.at_rest(time), motion=Motion([np.eye(4)])) if part.motion else part for part in parts]
    expected = pictures(Scene(still, sky=(0.1, 0.1, 0.1)), int(24 * time))
    assert np.isfinite(moving.motion).all()
    for name in ("emission", "albedo", "normal", "depth", "roughness", "id"):
        assert_allclose(getattr(moving, name), getattr(expected, name), rtol=1e-4, atol=1e-5, err_msg=name)
    # A mirrored lamp has its corners in another order, and so other points of it are picked.
    assert_allclose(moving.color.mean(), expected.color.mean(), rtol=0.03)


@pytest.mark.parametrize("size", ["grown from nothing", "flat at first", "flat later", "turned inside out"])
def test_a_lamp_of_a_file_shines_from_its_front(tmp_path: Path, size: str) -> None:
    """That is the side it has without a size: glTF turns the winding of mirrored things over."""
    buffers = Buffers()
    sampler = {"input": buffers.add([0, 1]), "output": buffers.add(SIZES[size])}
    animation = {"samplers": [sampler], "channels": [{"sampler": 0, "target": {"node": 0, "path": "scale"}}]}
    meshes = [{"primitives": [buffers.square()]}]
    materials = [{"emissiveFactor": WHITE}]
    path = write_gltf(tmp_path / "a.gltf", buffers, animations=[animation], meshes=meshes, materials=materials)
    for number in (20, 24):
        shines = size != "turned inside out"
        assert pictures(load_scene(path, (0.0, 0.0, 0.0)), number).color[8, 8, 0] == (1.0 if shines else 0.0)


@pytest.mark.skipif(not CASES.is_dir(), reason=f"{CASES} is not there")
@pytest.mark.parametrize("name", ["lamp_scaled_from_0.gltf", "lamp_flat_at_first.gltf"])
def test_the_cases_that_were_reported(name: str) -> None:
    scene = load_scene(CASES / name, WHITE)
    assert (render_frame(Shot(scene, SHAPE, 24, FRONT), 20, jitter=False).emission[8, 8] == 1.0).all()
