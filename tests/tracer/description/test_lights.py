from __future__ import annotations

import numpy as np

from svgf_cl_tracer.description.lights import Rectangle, SunLight


def test_a_rectangle_shines_to_the_side_of_u_x_v() -> None:
    light = Rectangle(
        type="rect", corner=(1.0, 2.0, 3.0), edge_u=(0.0, 2.0, 0.0), edge_v=(0.0, 0.0, 3.0), radiance=(4.0, 5.0, 6.0)
    )
    instance = light.instance()
    np.testing.assert_array_equal(
        np.unique(instance.corners.reshape(-1, 3), axis=0), [[1, y, z] for y in (2, 4) for z in (3, 6)]
    )
    edges = np.diff(instance.corners, axis=1)
    np.testing.assert_allclose(np.cross(edges[:, 0], edges[:, 1]).sum(0), (12, 0, 0))  # twice its area
    assert (instance.material.emission, instance.material.base_colour) == ((4, 5, 6), (0, 0, 0))


def test_the_sun() -> None:
    sun = SunLight(type="sun", direction_to_light=(0.0, 2.0, 0.0), irradiance=(1.0, 2.0, 3.0), angular_radius_deg=5.0)
    light = sun.light()
    assert (light.direction_to_light, light.irradiance, light.angular_radius) == ((0, 2, 0), (1, 2, 3), 5)
