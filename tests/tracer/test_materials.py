from __future__ import annotations

import numpy as np
import pytest

from svgf_cl_tracer.errors import SceneError
from svgf_cl_tracer.materials import Material, Materials, base_colour, emitted_radiance, is_solid
from svgf_cl_tracer.motion import Track
from svgf_cl_tracer.textures import LINEAR

IMAGE = np.full((2, 2, 3), (10, 128, 255), np.uint8)
LEAF = np.array([[[255, 255, 255, 0], [255, 255, 255, 255]]], np.uint8)


def test_factors_multiply_textures() -> None:
    table = Materials.of([Material((0.1, 0.2, 0.3)), Material((0.5, 1.0, 0.25), (2.0, 3.0, 4.0), IMAGE, IMAGE)])
    texel = LINEAR[IMAGE[0, 0]]
    assert base_colour(table, 0, 0.3, 0.3) == (0.1, 0.2, 0.3)
    assert emitted_radiance(table, 0, 0.3, 0.3) == (0.0, 0.0, 0.0)
    np.testing.assert_allclose(base_colour(table, 1, 0.3, 0.3), texel * (0.5, 1.0, 0.25), rtol=1e-6)
    np.testing.assert_allclose(emitted_radiance(table, 1, 0.3, 0.3), texel * (2.0, 3.0, 4.0), rtol=1e-6)


def test_an_image_that_materials_share_is_stored_once() -> None:
    table = Materials.of([Material(base_texture=IMAGE), Material(emission_texture=IMAGE, base_texture=LEAF)])
    np.testing.assert_array_equal(table.base_texture, (0, 1))
    np.testing.assert_array_equal(table.emission_texture, (-1, 0))
    assert len(table.textures.texels) == 4 + 2


def test_a_point_is_solid_from_the_cutoff_on() -> None:
    table = Materials.of([Material(base_texture=LEAF, alpha_cutoff=0.5), Material(alpha_cutoff=0.5)])
    assert not is_solid(table, 0, 0.25, 0.5)
    assert is_solid(table, 0, 0.75, 0.5)
    assert is_solid(table, 0, 0.5, 0.5)
    assert not is_solid(table, 0, 0.499, 0.5)
    assert is_solid(table, 0, 0.999, 0.5)
    assert not is_solid(table, 0, 1.001, 0.5)
    assert is_solid(table, 1, 0.25, 0.5)


def test_mean_emission_averages_the_texture_and_follows_the_brightness() -> None:
    half = IMAGE.copy()
    half[0] = 0
    switch = Track([0.0, 1.0], [[1.0], [0.25]], step=True)
    lamp = Material(emission=(4.0, 4.0, 4.0), emission_texture=half, brightness=switch)
    np.testing.assert_allclose(lamp.emission_at(0.5), 2 * LINEAR[IMAGE[0, 0]], rtol=1e-6)
    np.testing.assert_allclose(lamp.emission_at(1.0), LINEAR[IMAGE[0, 0]] / 2, rtol=1e-6)


def test_the_opacity_of_an_emission_texture_counts_for_nothing() -> None:
    texture = np.full((1, 1, 4), (255, 255, 255, 9), np.uint8)
    np.testing.assert_allclose(Material(emission=(1, 2, 3), emission_texture=texture).emission_at(0.0), (1, 2, 3))


def test_brightness_is_never_below_0() -> None:
    assert Material().brightness_at(3.0) == 1.0
    assert Material(brightness=Track([0.0], [[-1.0]])).brightness_at(3.0) == 0.0


@pytest.mark.parametrize("colour", [(0.0, np.nan, 0.0), (1.0, 1.0, np.inf), (-0.1, 1.0, 1.0)])
def test_colours_are_finite_and_not_below_0(colour: tuple[float, float, float]) -> None:
    with pytest.raises(SceneError, match="colour"):
        Material(colour)
    with pytest.raises(SceneError, match="finite emission >= 0"):
        Material(emission=colour)


@pytest.mark.parametrize(
    ("wrong", "named"),
    [
        ({"metallic": 1.5}, "metallic in 0..1, got 1.5"),
        ({"roughness": -0.5}, "roughness in 0..1, got -0.5"),
        ({"roughness": np.nan}, "roughness in 0..1, got nan"),
        ({"ior": 0.9}, "refractive index >= 1, got 0.9"),
        ({"ior": np.inf}, "refractive index >= 1, got inf"),
        ({"alpha_cutoff": 1.5}, "alpha_cutoff in 0..1, got 1.5"),
        ({"base_colour": (0.5, 1.5, 0.5)}, r"colour in 0..1, got \(0.5, 1.5, 0.5\)"),
        ({"base_texture": np.zeros((4, 4), np.uint8)}, r"base_texture \(h, w, 3\) or .* got \(4, 4\) uint8"),
        ({"emission_texture": np.zeros((4, 4, 3))}, r"emission_texture \(h, w, 3\) or .* float64"),
    ],
)
def test_numbers_out_of_range_are_named(wrong: dict[str, float], named: str) -> None:
    with pytest.raises(SceneError, match=named):
        Material(**wrong)
