from __future__ import annotations

import math

import numba
import numpy as np
import pytest
from numpy.typing import NDArray

from tracer import bsdf
from tracer.bsdf import Reflection, reflection
from tracer.energy import ALPHA_FLOOR
from tracer.vec3 import Vec3

WHITE = (1.0, 1.0, 1.0)
ROUGHNESSES = (0.0, 0.02, 0.1, 0.3, 0.6, 1.0)
# Also almost along the surface.
COSINES = (1.0, 0.7, 0.3, 0.05, 0.01)
SURFACES = {
    "white dielectric": (WHITE, 0.0, 1.5),
    "white metal": (WHITE, 1.0, 1.5),
    "gold": ((1.0, 0.71, 0.29), 1.0, 1.5),
    "red diamond": ((0.8, 0.1, 0.1), 0.0, 2.4),
    "half metal": ((0.9, 0.6, 0.3), 0.5, 1.5),
}
COUNT = 40_000

surfaces = pytest.mark.parametrize("surface", SURFACES)
roughnesses = pytest.mark.parametrize("roughness", ROUGHNESSES)


def make(surface: str, roughness: float) -> Reflection:
    base, metallic, ior = SURFACES[surface]
    return reflection(base, metallic, roughness, ior)


def under(cosine: float) -> Vec3:
    """A direction that is in no plane of an axis."""
    sine = math.sqrt(1.0 - cosine * cosine)
    return 0.8 * sine, 0.6 * sine, cosine


def uniform(count: int = COUNT) -> NDArray[np.float64]:
    """Points (count, 2) spread evenly over the unit square: an R2 sequence."""
    return (0.5 + np.outer(np.arange(1, count + 1), (0.7548776662466927, 0.5698402909980532))) % 1.0


@numba.njit
def weights(r: Reflection, wo: Vec3, u: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Scattering functions over densities at samples of the specular and of the diffuse lobe, (N, 3) each."""
    specular, diffuse = np.zeros((len(u), 3)), np.zeros((len(u), 3))
    for n in range(len(u)):
        wi = bsdf.sample_specular(r, wo, u[n, 0], u[n, 1])
        density = bsdf.specular_density(r, wo, wi)
        if density > 0.0:
            specular[n] = np.array(bsdf.evaluate_specular(r, wo, wi)) / density
        wi = bsdf.sample_diffuse(u[n, 0], u[n, 1])
        diffuse[n] = np.array(bsdf.evaluate_diffuse(r, wo, wi)) / bsdf.diffuse_density(wi)
    return specular, diffuse


@surfaces
@roughnesses
def test_both_lobes_sampled_give_the_albedo(surface: str, roughness: float) -> None:
    r = make(surface, roughness)
    for cosine in COSINES:
        specular, diffuse = weights(r, under(cosine), uniform())
        np.testing.assert_allclose((specular + diffuse).mean(0), bsdf.albedo(r, cosine), atol=0.01)


@pytest.mark.parametrize("surface", ["white dielectric", "white metal"])
def test_white_surfaces_reflect_all_light(surface: str) -> None:
    for roughness in ROUGHNESSES:
        for cosine in COSINES:
            np.testing.assert_allclose(bsdf.albedo(make(surface, roughness), cosine), WHITE, atol=1e-6)


@surfaces
@roughnesses
def test_a_sample_weighs_little(surface: str, roughness: float) -> None:
    r = make(surface, roughness)
    assert max(weights(r, under(cosine), uniform())[0].max() for cosine in COSINES) < 4.0


@surfaces
@roughnesses
def test_both_lobes_are_reciprocal(surface: str, roughness: float) -> None:
    r = make(surface, roughness)
    for a, b in zip(uniform(32), uniform(64)[32:], strict=True):
        wo, wi = bsdf.sample_diffuse(*a), bsdf.sample_diffuse(*b)
        for evaluate in (bsdf.evaluate_diffuse, bsdf.evaluate_specular):
            there = np.array(evaluate(r, wo, wi)) / wi[2]
            np.testing.assert_allclose(there, np.array(evaluate(r, wi, wo)) / wo[2], rtol=1e-9)


def test_a_dielectric_of_refractive_index_1_is_lambertian() -> None:
    r = reflection((0.2, 0.4, 0.6), 0.0, 0.3, 1.0)
    wo, wi = under(0.3), under(0.6)
    assert bsdf.is_lambertian(r)
    assert bsdf.specular_share(r, 0.3) == 0.0
    assert bsdf.albedo(r, 0.3) == (0.2, 0.4, 0.6)
    assert bsdf.evaluate_specular(r, wo, wi) == (0.0, 0.0, 0.0)
    np.testing.assert_allclose(bsdf.evaluate_diffuse(r, wo, wi), np.array((0.2, 0.4, 0.6)) * 0.6 / math.pi)


def test_roughness_ends_at_the_floor() -> None:
    assert reflection(WHITE, 1.0, 0.0, 1.5).alpha == ALPHA_FLOOR
    assert reflection(WHITE, 1.0, 0.5, 1.5).alpha == 0.25
