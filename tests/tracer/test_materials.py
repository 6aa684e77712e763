from __future__ import annotations

import numpy as np
import pytest

from tracer.errors import SceneError
from tracer.materials import Material, MaterialTable
from tracer.textures import LINEAR

IMAGE = np.full((2, 2, 3), (10, 128, 255), np.uint8)
UV = np.zeros((2, 3), np.float32)


def test_factors_multiply_textures() -> None:
    materials = [Material((0.1, 0.2, 0.3)), Material((0.5, 1.0, 0.25), (2.0, 2.0, 2.0), IMAGE, IMAGE)]
    table = MaterialTable(materials)
    albedo = table.albedo(np.array([0, 1, 0], np.int32), UV)
    texel = LINEAR[IMAGE[0, 0]]
    np.testing.assert_allclose(albedo.T, [(0.1, 0.2, 0.3), texel * (0.5, 1.0, 0.25), (0.1, 0.2, 0.3)], rtol=1e-6)
    emission = table.emission(np.array([0, 1, 0], np.int32), UV)
    np.testing.assert_allclose(emission.T, [(0, 0, 0), 2 * texel, (0, 0, 0)], rtol=1e-6)


def test_mean_emission_averages_the_texture() -> None:
    half = IMAGE.copy()
    half[0] = 0
    material = Material(emission=(4.0, 4.0, 4.0), emission_texture=half)
    np.testing.assert_allclose(material.mean_emission(), 2 * LINEAR[IMAGE[0, 0]], rtol=1e-6)


@pytest.mark.parametrize("colour", [(0.0, np.nan, 0.0), (1.0, 1.0, np.inf), (-0.1, 1.0, 1.0)])
def test_colours_are_finite_and_not_below_0(colour: tuple[float, float, float]) -> None:
    with pytest.raises(SceneError, match="finite colour >= 0"):
        Material(colour)
    with pytest.raises(SceneError, match="finite emission >= 0"):
        Material(emission=colour)
