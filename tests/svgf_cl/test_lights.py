"""Taking a picture apart into its light passes, and putting it together again."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.testing import assert_allclose, assert_array_equal

from svgf_cl.io.shot import Light
from svgf_cl.lights import REST, WHOLE, Parts, finite, limited, multiplied, remainder
from tests.frames import wall

SHAPE = (3, 5)
RADIANCE = arrays(np.float32, (*SHAPE, 3), elements=st.floats(0, 64, width=16))
FACTOR = arrays(np.float32, (*SHAPE, 3), elements=st.floats(0, 1, width=16))


def light(name: str, radiance: float | np.ndarray, factor: np.ndarray | None = None, *, filtered: bool = True) -> Light:
    channels, of_factor = (tuple(f"{each}.{c}" for c in "RGB") for each in (name, f"{name} factor"))
    plane = np.broadcast_to(np.asarray(radiance, np.float32), (*SHAPE, 3))
    return Light(channels, plane, factor, of_factor if factor is not None else (), filtered)


def terms(lights: list[Light]) -> np.ndarray:
    return np.sum([multiplied(each.radiance, each.factor) for each in lights], axis=0, dtype=np.float32)


@given(RADIANCE, RADIANCE, FACTOR, RADIANCE)
def test_what_is_left_as_it_is_gives_the_picture(
    diffuse: np.ndarray, lamp: np.ndarray, factor: np.ndarray, color: np.ndarray
) -> None:
    """Lights that are brighter than the picture are darkened to it, but for those that have no noise."""
    frame = wall(SHAPE, color=color)
    lights = [light("diffuse", diffuse, factor), light("lamp", lamp, filtered=False)]
    darker, rest = limited(lights, remainder(frame, lights))
    assert all((new.radiance <= old.radiance).all() for new, old in zip(darker, lights, strict=True))
    assert darker[1] is lights[1]
    made = {each.channels: each.radiance for each in darker} | {REST: np.maximum(rest, 0)}
    found = Parts(frame, darker, rest).composed(made)
    assert_allclose(found.picture, color, rtol=0.01, atol=0.01 * (1 + terms(lights).max()))


@given(RADIANCE, RADIANCE, FACTOR)
def test_lights_that_add_up_leave_nothing_and_stay(diffuse: np.ndarray, lamp: np.ndarray, factor: np.ndarray) -> None:
    lights = [light("diffuse", diffuse, factor), light("lamp", lamp, filtered=False)]
    rest = remainder(wall(SHAPE, color=terms(lights)), lights)
    assert not rest.any()
    assert limited(lights, rest)[0] is lights


def test_light_without_a_pass_is_the_rest() -> None:
    lights = [light("diffuse", 1.0)]
    assert_allclose(remainder(wall(SHAPE, color=1.5), lights), 0.5)
    assert not remainder(replace(wall(SHAPE), color=None, direct=np.ones((*SHAPE, 3), np.float32)), lights).any()


def test_lights_are_darkened_by_one_share() -> None:
    lights = [light("direct", 3.0), light("indirect", 1.0), light("lamp", 1.0, filtered=False)]
    darker, rest = limited(lights, np.full((*SHAPE, 3), -1.0, np.float32))
    assert_allclose([each.radiance[0, 0, 0] for each in darker], (2.25, 0.75, 1.0))
    assert not rest.any()


def test_a_lamp_that_is_brighter_than_the_picture_leaves_less_than_nothing() -> None:
    """Something covers a part of the pixel, which no filter can tell."""
    lights = [light("direct", 1.0), light("lamp", 4.0, filtered=False)]
    darker, rest = limited(lights, np.full((*SHAPE, 3), -3.0, np.float32))
    assert not darker[0].radiance.any()
    assert_array_equal(rest, -2.0)
    found = Parts(wall(SHAPE), darker, rest).composed({})
    assert_array_equal(found.picture, 2.0)


def test_a_part_that_was_not_filtered_is_as_in_the_file() -> None:
    lights = [light("dark", 0.0), light("lit", 1.0, np.full((*SHAPE, 3), 0.5, np.float32))]
    found = Parts(wall(SHAPE), lights, np.zeros((*SHAPE, 3), np.float32)).composed(
        {lights[1].channels: np.full((*SHAPE, 3), 4.0, np.float32)}
    )
    assert_array_equal(found.picture, 2.0)
    assert_array_equal(found.lights[lights[0].channels], 0.0)
    assert_array_equal(found.lights[lights[1].channels], 4.0)


def test_new_factors_are_written_and_those_of_the_file_are_not() -> None:
    factor = np.full((*SHAPE, 3), 0.5, np.float32)
    lights = [light("lit", 1.0, factor)]
    parts = Parts(wall(SHAPE), lights, np.zeros((*SHAPE, 3), np.float32), {lights[0].factor_channels: factor})
    assert parts.composed({}).lights.keys() == {lights[0].channels, lights[0].factor_channels}
    assert replace(parts, factors={}).composed({}).lights.keys() == {lights[0].channels}


def test_a_picture_without_lights_is_the_filtered_one() -> None:
    picture, error = np.ones((*SHAPE, 3), np.float32), np.ones(SHAPE, np.float32)
    found = Parts(wall(SHAPE)).composed({WHOLE: picture}, error)
    assert found.picture is picture
    assert found.standard_error is error
    assert found.lights == {}


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_a_light_that_is_not_finite_is_black(value: float) -> None:
    radiance, factor = (np.ones((*SHAPE, 3), np.float32) for _ in range(2))
    radiance[0, 0, 0] = factor[1, 1, 1] = value
    found = finite(light("lit", radiance, factor))
    assert found.radiance[0, 0, 0] == found.factor[1, 1, 1] == 0.0
    assert np.sum(found.radiance) == np.sum(found.factor) == 3 * np.prod(SHAPE) - 1
    assert finite(light("lit", 1.0)).factor is None
