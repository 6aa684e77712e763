from __future__ import annotations

from collections.abc import Callable

import numpy as np

from tracer.geometry import Instance, Triangles
from tracer.lights import AreaLights
from tracer.materials import Material, MaterialTable


def lights(instances: list[Instance]) -> AreaLights:
    materials = [instance.material for instance in instances]
    return AreaLights(Triangles(instances, range(len(instances))), materials, MaterialTable(materials))


def lamp(*emission: float) -> Material:
    return Material((0.0, 0.0, 0.0), emission=emission)


def test_power_is_the_mean_of_radiance_over_density(quad: Callable[..., Instance]) -> None:
    small = quad((0, 0, 0), (1, 0, 0), (0, 1, 0), lamp(1, 2, 3))
    large = quad((0, 0, 9), (3, 0, 0), (0, 2, 0), lamp(4, 0, 1))
    dark = quad((0, 0, 5), (9, 0, 0), (0, 9, 0))
    found = lights([small, dark, large])
    assert found.count == 4
    _, _, radiance = found.sample(np.random.default_rng(1).random((3, 40_000), np.float32))
    np.testing.assert_allclose(radiance.mean(1), (1 + 6 * 4, 2, 3 + 6), rtol=0.02)


def test_samples_lie_on_the_lamps_and_face_their_front(quad: Callable[..., Instance]) -> None:
    found = lights([quad((1, 2, 3), (2, 0, 0), (0, 4, 0), lamp(1, 1, 1))])
    position, normal, _ = found.sample(np.random.default_rng(1).random((3, 10_000), np.float32))
    np.testing.assert_allclose(position.min(1), (1, 2, 3), atol=0.05)
    np.testing.assert_allclose(position.max(1), (3, 6, 3), atol=0.05)
    np.testing.assert_allclose(position.mean(1), (2, 4, 3), atol=0.05)
    np.testing.assert_allclose(normal, np.repeat([[0.0], [0.0], [1.0]], 10_000, axis=1))


def test_a_textured_lamp_shines_as_its_texture_says(quad: Callable[..., Instance]) -> None:
    image = np.zeros((1, 2, 3), np.uint8)
    image[0, 1] = 255
    material = Material(emission=(2.0, 2.0, 2.0), emission_texture=np.repeat(image, 64, axis=1))
    position, _, radiance = lights([quad((0, 0, 0), (1, 0, 0), (0, 1, 0), material)]).sample(
        np.random.default_rng(1).random((3, 20_000), np.float32)
    )
    assert radiance[0, (position[0] > 0.02) & (position[0] < 0.48)].max() == 0
    np.testing.assert_allclose(radiance.mean(1), 1.0, rtol=0.03)
