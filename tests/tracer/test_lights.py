from __future__ import annotations

import numpy as np
import pytest

from svgf_cl_tracer.errors import SceneError
from svgf_cl_tracer.lights import PointLight, Sun
from svgf_cl_tracer.motion import Keyframes, Motion, Track


def test_a_light_at_rest_is_where_it_was_put() -> None:
    position, direction = PointLight((1, 2, 3), (1, 1, 1), direction=(0, 0, -5)).placed(7.0)
    np.testing.assert_array_equal(position, (1, 2, 3))
    np.testing.assert_array_equal(direction, (0, 0, -1))


def test_motion_carries_position_and_direction() -> None:
    half_turn = Motion.turning((0, 0, 0), (0, 1, 0), [0.0, 1.0, 2.0], [0.0, 90.0, 180.0])
    grown = Keyframes(scale=Track([0.0], [(2.0, 2.0, 2.0)]))
    light = PointLight((1, 2, 3), (1, 1, 1), direction=(0, 0, -1), motion=Motion([*half_turn.links, grown]))
    position, direction = light.placed(2.0)
    np.testing.assert_allclose(position, (-2, 4, -6), atol=1e-12)
    np.testing.assert_allclose(direction, (0, 0, 1), atol=1e-12)


@pytest.mark.parametrize(
    ("wrong", "named"),
    [
        ({"direction_to_light": (0.0, 0.0, 0.0)}, "length above 0"),
        ({"direction_to_light": (0.0, np.nan, 1.0)}, "direction"),
        ({"irradiance": (1.0, -1.0, 1.0)}, "irradiance >= 0"),
        ({"irradiance": (1.0, np.inf, 1.0)}, "irradiance >= 0"),
        ({"angular_radius": -1.0}, r"\[0, 90\), got -1.0"),
        ({"angular_radius": 90.0}, r"\[0, 90\), got 90.0"),
    ],
)
def test_suns_out_of_range_are_refused(wrong: dict, named: str) -> None:
    with pytest.raises(SceneError, match=f"sun: .*{named}"):
        Sun(**({"direction_to_light": (0, 1, 0), "irradiance": (1, 1, 1)} | wrong))


@pytest.mark.parametrize(
    ("wrong", "named"),
    [
        ({"position": (0.0, np.inf, 0.0)}, "finite position"),
        ({"direction": (0.0, 0.0, 0.0)}, "direction"),
        ({"intensity": (np.nan, 1.0, 1.0)}, "intensity >= 0"),
        ({"intensity": (-1.0, 1.0, 1.0)}, "intensity >= 0"),
        ({"inner_angle": 50.0, "outer_angle": 40.0}, "got 50.0, 40.0"),
        ({"inner_angle": -1.0}, "got -1.0, 180.0"),
        ({"outer_angle": 181.0}, "got 180.0, 181.0"),
        ({"reach": 0.0}, "reach above 0, got 0.0"),
    ],
)
def test_lights_out_of_range_are_refused(wrong: dict, named: str) -> None:
    with pytest.raises(SceneError, match=f"light: .*{named}"):
        PointLight(**({"position": (0, 0, 0), "intensity": (1, 1, 1)} | wrong))
