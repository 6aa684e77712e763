from __future__ import annotations

import math

import numba
import numpy as np
import pytest
from numpy.typing import NDArray

from svgf_cl_tracer.errors import SceneError
from svgf_cl_tracer.sky import Environment, SkyTable, sample_sky, sky_density, sky_radiance, sky_table
from svgf_cl_tracer.vec3 import Vec3

# A turn about an axis without a name.
TURN = np.array([[2, -1, 2], [2, 2, -1], [-1, 2, 2]]) / 3.0
COUNT = 50_000


def image(height: int = 8, width: int = 16, sun: float = 200.0) -> NDArray[np.float32]:
    """Noise with one bright texel."""
    result = np.random.default_rng(1).random((height, width, 3)).astype(np.float32)
    result[height // 4, width // 8] = sun
    return result


def uniform() -> NDArray[np.float64]:
    """Points (COUNT, 2) spread evenly over the unit square: an R2 sequence."""
    return (0.5 + np.outer(np.arange(1, COUNT + 1), (0.7548776662466927, 0.5698402909980532))) % 1.0


@numba.njit
def samples(table: SkyTable, u: NDArray[np.float64]) -> tuple[NDArray, NDArray, NDArray, NDArray]:
    """Sampled directions, the densities given with them and for them, and the radiance there."""
    direction, given = np.empty((len(u), 3)), np.empty(len(u))
    density, radiance = np.empty(len(u)), np.empty((len(u), 3))
    for n in range(len(u)):
        wi, given[n] = sample_sky(table, u[n, 0], u[n, 1])
        direction[n] = np.array(wi)
        density[n] = sky_density(table, wi)
        radiance[n] = np.array(sky_radiance(table, wi))
    return direction, given, density, radiance


@numba.njit
def everywhere(table: SkyTable, u: NDArray[np.float64]) -> tuple[NDArray, NDArray, NDArray]:
    """Directions spread evenly over the sphere, density and radiance there."""
    direction, density, radiance = np.empty((len(u), 3)), np.empty(len(u)), np.empty((len(u), 3))
    for n in range(len(u)):
        z, azimuth = 1.0 - 2.0 * u[n, 0], 2.0 * math.pi * u[n, 1]
        radius = math.sqrt(1.0 - z * z)
        wi = (radius * math.cos(azimuth), radius * math.sin(azimuth), z)
        direction[n] = np.array(wi)
        density[n] = sky_density(table, wi)
        radiance[n] = np.array(sky_radiance(table, wi))
    return direction, density, radiance


@pytest.mark.parametrize("shape", [(8, 16), (1, 1), (1, 4), (2, 1), (5, 3)])
def test_samples_have_the_density_that_is_told(shape: tuple[int, int]) -> None:
    table = sky_table(Environment(image(*shape), TURN))
    direction, given, density, _ = samples(table, uniform())
    np.testing.assert_allclose(np.linalg.norm(direction, axis=1), 1.0)
    np.testing.assert_allclose(density, given, rtol=1e-6)
    there, expected, _ = everywhere(table, uniform())
    np.testing.assert_allclose(4.0 * np.pi * expected.mean(), 1.0, rtol=0.01)
    for power in (1, 2, 3):
        moments = 4.0 * np.pi * (there**power * expected[:, None]).mean(0)
        np.testing.assert_allclose((direction**power).mean(0), moments, atol=0.01)


def test_samples_follow_the_radiance() -> None:
    table = sky_table(Environment(image(64, 128)))
    _, density, _, radiance = samples(table, uniform())
    weight = radiance @ (0.2126, 0.7152, 0.0722) / density
    assert weight.std() < 0.1 * weight.mean()
    assert weight.max() < 1.5 * weight.mean()


def test_the_mean_is_that_over_the_sphere() -> None:
    table = sky_table(Environment(image(32, 64), TURN))
    np.testing.assert_allclose(everywhere(table, uniform())[2].mean(0), table.mean_radiance, rtol=0.02)


@pytest.mark.parametrize(
    ("row", "column", "direction"),
    [
        (4, 8, (0, 0, 1)),
        (4, 4, (1, 0, 0)),
        (4, 12, (-1, 0, 0)),
        (4, 0, (0, 0, -1)),
        (0, 8, (0, 1, 0)),
        (8, 8, (0, -1, 0)),
    ],
)
def test_orientation(row: int, column: int, direction: Vec3) -> None:
    """Positions are corners of texels: the four around the direction are lit."""
    picture = np.zeros((8, 16, 3), np.float32)
    rows, columns = [max(row - 1, 0), min(row, 7)], [column - 1, column]
    picture[np.ix_(rows, range(16) if row in (0, 8) else columns)] = 1.0
    for to_world in (np.eye(3), TURN):
        x, y, z = to_world @ direction
        table = sky_table(Environment(picture, to_world))
        np.testing.assert_allclose(sky_radiance(table, (x, y, z)), 1.0, atol=1e-6)
        assert sky_radiance(table, (-x, -y, -z)) == (0.0, 0.0, 0.0)


@pytest.mark.parametrize("sky", [None, (0.25, 0.5, 2.0), Environment(np.zeros((4, 8, 3), np.float32))])
def test_a_constant_sky_is_not_sampled(sky: Vec3 | Environment | None) -> None:
    table = sky_table(sky)
    assert sky_radiance(table, (0.6, 0.0, 0.8)) == (sky if isinstance(sky, tuple) else (0.0, 0.0, 0.0))
    assert sky_density(table, (0.6, 0.0, 0.8)) == 0.0
    assert sample_sky(table, 0.3, 0.6)[1] == 0.0


def test_only_texels_that_shine_are_sampled() -> None:
    picture = np.zeros((16, 32, 3), np.float32)
    picture[5, 7] = 1.0
    _, _, density, radiance = samples(sky_table(Environment(picture)), uniform())
    assert density.min() > 0.0
    assert radiance.min() > 0.0


@pytest.mark.parametrize(
    ("picture", "to_world", "message"),
    [
        (np.ones((4, 8)), np.eye(3), "shape"),
        (np.full((4, 8, 3), np.nan), np.eye(3), "finite"),
        (np.full((4, 8, 3), -1.0), np.eye(3), ">= 0"),
        (np.ones((4, 8, 3)), 2.0 * np.eye(3), "rotation"),
    ],
)
def test_an_environment_says_what_is_wrong(picture: NDArray, to_world: NDArray, message: str) -> None:
    with pytest.raises(SceneError, match=message):
        Environment(picture, to_world)
