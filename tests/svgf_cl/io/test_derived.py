"""Depth and motion that are computed from positions, distances and cameras."""

from __future__ import annotations

import numpy as np

from svgf_cl import Camera
from svgf_cl.io.derived import derived
from tests.renderers import SHAPE, moment

AT = moment(2)


def test_positions_tell_depth_before_distances_do() -> None:
    position, normal = AT.position.astype(np.float32), AT.frame.normal
    values = {"position": position, "distance": np.ones(SHAPE, np.float32), "normal": normal}
    found = derived(values, AT.camera, moment(1).camera, still=False)
    np.testing.assert_allclose(found["depth"], AT.frame.depth, atol=5e-6)
    np.testing.assert_allclose(found["motion"], AT.frame.motion, atol=1e-4)
    assert (found["depth"].dtype, found["motion"].dtype) == (np.float32, np.float32)


def test_nothing_is_computed_of_what_is_there() -> None:
    values = {"depth": AT.frame.depth, "motion": AT.frame.motion, "position": AT.position, "normal": AT.frame.normal}
    found = derived(values, AT.camera, AT.camera, still=True)
    assert "motion" not in found
    np.testing.assert_array_equal(found.get("depth", values["depth"]), AT.frame.depth)


def test_positions_that_are_not_finite_or_behind_the_camera_are_no_surfaces() -> None:
    position = AT.position.astype(np.float32)
    position[0, 0], position[0, 1] = np.nan, np.inf
    position[0, 2] = AT.camera.to_world([0.0, 0.0, -1.0])
    values = {"position": position, "normal": AT.frame.normal}
    found = derived(values, AT.camera, moment(1).camera, still=False)
    assert np.isinf(found["depth"][0, :3]).all()
    assert np.isfinite(found["motion"]).all()


def test_nothing_is_known_without_camera_or_depth() -> None:
    assert derived({"position": AT.position, "normal": AT.frame.normal}, None, None, still=True) == {}
    assert derived({"normal": AT.frame.normal}, AT.camera, AT.camera, still=False) == {}


def test_an_orthographic_camera_sees_distances_as_depths() -> None:
    camera = Camera(world_to_view=np.eye(4), focal=(9.0, 9.0), center=(15.5, 9.5), orthographic=True)
    values = {"distance": np.full(SHAPE, 3, np.float32), "normal": AT.frame.normal}
    depth = derived(values, camera, camera, still=False)["depth"]
    assert (depth[AT.hit] == 3).all()
    assert np.isinf(depth[~AT.hit]).all()
