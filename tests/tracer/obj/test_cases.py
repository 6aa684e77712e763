"""The OBJ files of ../shared/cases, each with what its README says is right."""

from __future__ import annotations

import warnings
from pathlib import Path

import numpy as np
import pytest

from svgf_cl.frame import Frame
from svgf_cl_tracer import Camera, CameraPath, Shot, load_scene, render_frame

CASES = Path(__file__).parents[4] / "shared" / "cases" / "obj"

pytestmark = pytest.mark.skipif(not CASES.exists(), reason=f"{CASES} is not here")


def seen(name: str, distance: float, size: int) -> Frame:
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # nothing of these is lost
        scene = load_scene(CASES / name, (1.0, 1.0, 1.0))
    camera = CameraPath.static(Camera((0, 0, distance), (0, 0, 0), fov_y=30.0))
    return render_frame(Shot(scene, (size, size), camera_path=camera), 0, jitter=False)


@pytest.mark.parametrize(("name", "share"), [("concave_L.obj", 3 / 16), ("relative_interleaved.obj", 1.0)])
def test_how_much_is_covered(name: str, share: float) -> None:
    assert (seen(name, 7.4641, 128).id > 0).mean() == share


@pytest.mark.parametrize(
    ("name", "albedo"),
    [("texture_options.obj", (1, 0, 0)), ("other_case.obj", (1, 0, 0)), ("one_number.obj", (0.5, 0.5, 0.5))],
)
def test_albedo(name: str, albedo: tuple[float, float, float]) -> None:
    frame = seen(name, 2.0, 8)
    np.testing.assert_allclose(frame.albedo, np.broadcast_to(albedo, frame.albedo.shape), atol=1e-6)
