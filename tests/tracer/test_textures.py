from __future__ import annotations

import numpy as np
import pytest

from tracer.textures import LINEAR, Textures, srgb_to_linear, texture_colour, texture_opacity

SMALL = np.arange(0, 180, 10, dtype=np.uint8).reshape(2, 3, 3)
OTHER = np.full((1, 1, 3), (255, 0, 128), np.uint8)
LEAF = np.array([[[9, 9, 9, 0], [9, 9, 9, 255]], [[9, 9, 9, 51], [9, 9, 9, 102]]], np.uint8)
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
    np.testing.assert_allclose(texture_colour(ALL, 2, 0.9, 0.1), LINEAR[LEAF[0, 0, :3]], rtol=1e-6)


def test_opacity_is_linear_and_1_where_an_image_has_none() -> None:
    assert texture_opacity(ALL, 0, 0.2, 0.2) == 1.0
    assert texture_opacity(ALL, 2, 0.75, 0.75) == 1.0
    assert texture_opacity(ALL, 2, 0.25, 0.25) == pytest.approx(0.2)
    assert texture_opacity(ALL, 2, 0.5, 0.5) == pytest.approx((0 + 1 + 0.2 + 0.4) / 4)
