from __future__ import annotations

import numpy as np

from tracer.textures import LINEAR, Textures, srgb_to_linear

SMALL = np.arange(0, 180, 10, dtype=np.uint8).reshape(2, 3, 3)
OTHER = np.full((1, 1, 3), (255, 0, 128), np.uint8)


def sample(texture: int, *uv: tuple[float, float]) -> np.ndarray:
    points = np.array(uv, np.float32).T
    return Textures([SMALL, OTHER]).sample(np.full(len(uv), texture, np.int32), points).T


def test_srgb_decodes_its_ends_and_its_middle() -> None:
    np.testing.assert_allclose(
        srgb_to_linear(np.array([0.0, 0.04045, 0.5, 1.0])), (0, 0.0031308, 0.2140411, 1), atol=1e-6
    )


def test_texel_centres_are_exact_with_row_0_on_top() -> None:
    np.testing.assert_allclose(sample(0, (1 / 6, 0.75), (5 / 6, 0.25)), LINEAR[[SMALL[0, 0], SMALL[1, 2]]], rtol=1e-5)


def test_between_texels_the_linear_values_are_mixed() -> None:
    expected = LINEAR[SMALL[0, :2]].mean(0)
    np.testing.assert_allclose(sample(0, (1 / 3, 0.75))[0], expected, rtol=1e-5)


def test_textures_repeat() -> None:
    inside, outside = sample(0, (0.3, 0.4), (-1.7, 5.4))
    np.testing.assert_allclose(inside, outside, rtol=1e-4)
    across = LINEAR[SMALL[:, [2, 0]]].mean((0, 1))
    np.testing.assert_allclose(sample(0, (0.0, 0.0))[0], across, rtol=1e-5)


def test_each_texture_is_found() -> None:
    np.testing.assert_allclose(sample(1, (0.9, 0.1))[0], LINEAR[OTHER[0, 0]], rtol=1e-6)
