from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from svgf_cl_tracer.textures import LINEAR, Textures, srgb_to_linear, texture_colour, texture_opacity

SMALL = np.arange(0, 180, 10, dtype=np.uint8).reshape(2, 3, 3)
OTHER = np.full((1, 1, 3), (255, 0, 128), np.uint8)
LEAF = np.array([[[9, 80, 255, 0], [99, 9, 7, 255]], [[0, 9, 90, 51], [9, 9, 9, 102]]], np.uint8)
ALL = Textures.of([SMALL, OTHER, LEAF])


def test_srgb_decodes_its_ends_and_its_middle() -> None:
    np.testing.assert_allclose(
        srgb_to_linear(np.array([0.0, 0.04045, 0.5, 1.0])), (0, 0.0031308, 0.2140411, 1), atol=1e-6
    )


def test_texel_centres_are_exact_with_row_0_on_top() -> None:
    np.testing.assert_allclose(texture_colour(ALL, 0, 1 / 6, 0.75), LINEAR[SMALL[0, 0]], rtol=1e-6)
    np.testing.assert_allclose(texture_colour(ALL, 0, 5 / 6, 0.25), LINEAR[SMALL[1, 2]], rtol=1e-6)


def test_between_texels_the_linear_values_are_mixed() -> None:
    np.testing.assert_allclose(texture_colour(ALL, 0, 1 / 3, 0.75), LINEAR[SMALL[0, :2]].mean(0), rtol=1e-6)
    np.testing.assert_allclose(texture_colour(ALL, 0, 1 / 3, 0.5), LINEAR[SMALL[:, :2]].mean((0, 1)), rtol=1e-6)


@pytest.mark.parametrize(("u", "v"), [(0.3, 0.4), (0.01, 0.99), (0.99, 0.01)])
def test_textures_repeat(u: float, v: float) -> None:
    inside = texture_colour(ALL, 0, u, v)
    for across, up in ((-2, 5), (1, 0), (0, -1), (100, 100)):
        np.testing.assert_allclose(texture_colour(ALL, 0, u + across, v + up), inside, rtol=1e-6)


@pytest.mark.parametrize("corner", [(0.0, 0.0), (1.0, 1.0), (0.0, 1.0), (-1.0, 7.0), (-1e-18, -1e-18)])
def test_corners_mix_the_texels_of_all_four(corner: tuple[float, float]) -> None:
    np.testing.assert_allclose(texture_colour(ALL, 0, *corner), LINEAR[SMALL[:, [2, 0]]].mean((0, 1)), rtol=1e-6)


def test_each_texture_is_found() -> None:
    np.testing.assert_allclose(texture_colour(ALL, 1, 0.9, 0.1), LINEAR[OTHER[0, 0]], rtol=1e-6)
    np.testing.assert_allclose(texture_colour(ALL, 2, 0.25, 0.75), LINEAR[LEAF[0, 0, :3]], rtol=1e-6)


def test_an_image_without_opacity_is_opaque() -> None:
    assert texture_opacity(ALL, 0, 0.2, 0.2) == 1.0


@settings(deadline=None)  # the first call compiles
@given(st.floats(-2, 2), st.floats(-2, 2))
def test_colour_and_opacity_are_bilinear(u: float, v: float) -> None:
    x, y = u * 2 - 0.5, (1 - v) * 2 - 0.5
    left, top = math.floor(x), math.floor(y)
    texels = LEAF[np.ix_([top % 2, (top + 1) % 2], [left % 2, (left + 1) % 2])]
    weights = np.outer((1 - (y - top), y - top), (1 - (x - left), x - left))
    assert texture_opacity(ALL, 2, u, v) == pytest.approx((weights * texels[..., 3]).sum() / 255, abs=1e-9)
    colour = (weights[..., None] * LINEAR[texels[..., :3]]).sum((0, 1))
    np.testing.assert_allclose(texture_colour(ALL, 2, u, v), colour, rtol=1e-5)
