from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from svgf_cl_tracer.builtin import patterns
from svgf_cl_tracer.textures import Image

DARK, LIGHT, JOINT = (40, 50, 60), (200, 180, 160), (120, 120, 120)

PATTERNS: dict[str, Callable[[], Image]] = {
    "tiles": lambda: patterns.tiles(4, 6, DARK, LIGHT, JOINT),
    "bricks": lambda: patterns.bricks(4, 6, DARK, LIGHT, JOINT),
    "planks": lambda: patterns.planks(4, DARK, LIGHT),
    "marble": lambda: patterns.marble(128, 1, DARK, LIGHT),
    "plaster": lambda: patterns.plaster(128, 1, DARK, LIGHT),
}


@pytest.mark.parametrize("name", PATTERNS)
def test_a_pattern_lies_between_its_colours_and_is_the_same_each_time(name: str) -> None:
    image = PATTERNS[name]()
    assert image.dtype == np.uint8
    assert image.shape[2] == 3
    assert (image.mean((0, 1)) > np.minimum(DARK, 20)).all()
    assert (image.mean((0, 1)) < LIGHT).all()
    assert image.std() > 5
    np.testing.assert_array_equal(image, PATTERNS[name]())


@pytest.mark.parametrize("stretch", [1.0, 8.0])
def test_clouds_repeat_without_a_seam(stretch: float) -> None:
    clouds = patterns.clouds((64, 96), 3, stretch=stretch)
    assert (clouds.min(), clouds.max()) == (0.0, 1.0)
    for axis in (0, 1):
        seam = np.abs(np.take(clouds, 0, axis) - np.take(clouds, -1, axis)).mean()
        assert seam < 2.0 * np.abs(np.diff(clouds, axis=axis)).mean()


def test_stretched_clouds_vary_less_along_their_grain() -> None:
    clouds = patterns.clouds((64, 64), 3, stretch=8.0)
    assert 2.0 * np.abs(np.diff(clouds, axis=1)).mean() < np.abs(np.diff(clouds, axis=0)).mean()


def test_mixed_colours_are_the_ends_at_0_and_1() -> None:
    weight = np.array([[0.0, 0.5, 1.0]])
    np.testing.assert_allclose(patterns.mixed(weight, DARK, LIGHT), [[DARK, (120, 115, 110), LIGHT]])


def test_values_beyond_8_bits_are_clipped() -> None:
    np.testing.assert_array_equal(patterns.image([[[-5.0, 100.9, 400.0]]]), [[[0, 100, 255]]])
