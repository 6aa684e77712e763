from __future__ import annotations

import math

import numba
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from svgf_cl_tracer import bsdf
from svgf_cl_tracer.bsdf import Reflection, reflection
from svgf_cl_tracer.energy import ALPHA_FLOOR, mean_terms, terms
from svgf_cl_tracer.vec3 import Vec3

WHITE, BLACK = (1.0, 1.0, 1.0), (0.0, 0.0, 0.0)
WHITES = {"dielectric": reflection(WHITE, 0.0, 0.0, 1.5), "metal": reflection(WHITE, 1.0, 0.0, 1.5)}
ROUGHNESSES = (0.0, 0.02, 0.05, 0.1, 0.2, 0.35, 0.5, 0.7, 1.0)
# The last two go almost along the surface. The last has lobes too thin for `integrated`.
COSINES = (1.0, 0.8, 0.5, 0.2, 0.05, 0.01)
WIDE_COSINES, WIDE_ROUGHNESSES = COSINES[:-1], (0.35, 0.5, 0.7, 1.0)

whites = pytest.mark.parametrize("white", WHITES)
units = st.floats(0.0, 1.0)
colours = st.tuples(units, units, units)
reflections = st.builds(reflection, colours, units, units, st.floats(1.0, 3.0))
directions = st.builds(bsdf.sample_diffuse, st.floats(0.0, 0.999999), st.floats(0.0, 0.999999))
seeded = settings(derandomize=True, deadline=None)


def made(white: str, roughness: float) -> Reflection:
    return WHITES[white]._replace(alpha=max(roughness**2, ALPHA_FLOOR))


def under(cosine: float) -> Vec3:
    return math.sqrt(1.0 - cosine * cosine), 0.0, cosine


def uniform(count: int) -> NDArray[np.float64]:
    """Points (count, 2) spread evenly over the unit square: an R2 sequence."""
    return (0.5 + np.outer(np.arange(1, count + 1), (0.7548776662466927, 0.5698402909980532))) % 1.0


@numba.njit
def sampled(r: Reflection, wo: Vec3, u: NDArray[np.float64]) -> tuple[NDArray, NDArray, NDArray]:
    """Directions (N, 3) drawn from the specular lobe, and the weights (N,) of those and of diffuse samples."""
    directions, specular, diffuse = np.empty((len(u), 3)), np.zeros(len(u)), np.zeros(len(u))
    for n in range(len(u)):
        wi = bsdf.sample_specular(r, wo, u[n, 0], u[n, 1])
        directions[n] = np.array(wi)
        density = bsdf.specular_density(r, wo, wi)
        if density > 0.0:
            specular[n] = max(bsdf.evaluate_specular(r, wo, wi)) / density
        wi = bsdf.sample_diffuse(u[n, 0], u[n, 1])
        diffuse[n] = max(bsdf.evaluate_diffuse(r, wo[2], wi[2])) / bsdf.diffuse_density(wi[2])
    return directions, specular, diffuse


@numba.njit
def integrated(r: Reflection, wo: Vec3, count: int) -> tuple[NDArray, NDArray]:
    """Specular density, and both lobes together, over cells (count, 2 * count) of root of the cosine and azimuth."""
    density, light = np.zeros((count, 2 * count)), np.zeros((count, 2 * count))
    step = math.pi / count
    for i in range(count):
        root = (i + 0.5) / count
        polar = math.acos(root * root)
        for j in range(2 * count):
            azimuth = (j + 0.5) * step - math.pi
            wi = (math.sin(polar) * math.cos(azimuth), math.sin(polar) * math.sin(azimuth), math.cos(polar))
            solid_angle = 2.0 * root / count * step
            density[i, j] = bsdf.specular_density(r, wo, wi) * solid_angle
            light[i, j] = (
                bsdf.evaluate_diffuse(r, wo[2], wi[2])[0] + bsdf.evaluate_specular(r, wo, wi)[0]
            ) * solid_angle
    return density, light


@whites
@pytest.mark.parametrize("roughness", ROUGHNESSES)
def test_white_surfaces_reflect_all_light_that_is_sampled(white: str, roughness: float) -> None:
    for cosine in COSINES:
        _, specular, diffuse = sampled(made(white, roughness), under(cosine), uniform(40_000))
        assert abs(specular.mean() + diffuse.mean() - 1.0) < 0.01


@whites
@pytest.mark.parametrize("roughness", WIDE_ROUGHNESSES)
def test_white_surfaces_reflect_all_light_that_is_integrated(white: str, roughness: float) -> None:
    for cosine in WIDE_COSINES:
        assert abs(integrated(made(white, roughness), under(cosine), 400)[1].sum() - 1.0) < 0.01


@seeded
@given(reflections, directions)
def test_the_albedo_is_that_of_both_lobes(r: Reflection, wo: Vec3) -> None:
    brightest = max(range(3), key=lambda channel: bsdf.albedo(r, wo[2])[channel])
    one = Reflection((r.diffuse[brightest],) * 3, (r.f0[brightest],) * 3, r.alpha)
    _, specular, diffuse = sampled(one, wo, uniform(20_000))
    assert abs(specular.mean() + diffuse.mean() - bsdf.albedo(r, wo[2])[brightest]) < 0.01
    assert bsdf.albedo(r, wo[2])[brightest] <= 1.0 + 1e-9


@seeded
@given(reflections, directions, directions)
def test_both_lobes_are_reciprocal(r: Reflection, wo: Vec3, wi: Vec3) -> None:
    there, back = bsdf.evaluate_diffuse(r, wo[2], wi[2]), bsdf.evaluate_diffuse(r, wi[2], wo[2])
    np.testing.assert_allclose(np.divide(there, wi[2]), np.divide(back, wo[2]), rtol=1e-9)
    there, back = bsdf.evaluate_specular(r, wo, wi), bsdf.evaluate_specular(r, wi, wo)
    np.testing.assert_allclose(np.divide(there, wi[2]), np.divide(back, wo[2]), rtol=1e-9)


@seeded
@given(reflections, directions)
def test_no_sample_weighs_more_than_a_few(r: Reflection, wo: Vec3) -> None:
    _, specular, diffuse = sampled(r, wo, uniform(1000))
    assert specular.max() < 4.0
    assert diffuse.max() < 2.0


@pytest.mark.parametrize("roughness", WIDE_ROUGHNESSES)
def test_specular_samples_have_the_density_that_is_told(roughness: float) -> None:
    r = made("metal", roughness)
    for cosine in WIDE_COSINES:
        drawn, _, _ = sampled(r, under(cosine), uniform(50_000))
        above = drawn[drawn[:, 2] > 0.0]
        azimuth = np.arctan2(above[:, 1], above[:, 0])
        found, _, _ = np.histogram2d(
            np.sqrt(above[:, 2]), azimuth, bins=(5, 10), range=((0.0, 1.0), (-math.pi, math.pi))
        )
        expected = integrated(r, under(cosine), 400)[0].reshape(5, 80, 10, 80).sum((1, 3))
        np.testing.assert_allclose(found / len(drawn), expected, atol=3e-3)
        np.testing.assert_allclose(expected.sum() + (drawn[:, 2] <= 0.0).mean(), 1.0, atol=3e-3)


def test_a_lobe_at_the_floor_has_all_its_digits() -> None:
    r = reflection(WHITE, 1.0, 0.0, 1.5)
    assert r.alpha == ALPHA_FLOOR
    wo = under(0.6)
    # Towards and beside the mirror image, by twice the angle that halves the peak's fourth root.
    for tilt, share in ((0.0, 1.0), (math.atan(ALPHA_FLOOR), 0.25)):
        angle = math.acos(0.6) + 2.0 * tilt
        wi = (-math.sin(angle), 0.0, math.cos(angle))
        # The normal's own cosine counts four times; shadowing is none to six digits.
        expected = share / (math.pi * ALPHA_FLOOR**2 * math.cos(tilt) ** 4) / (4.0 * 0.6)
        np.testing.assert_allclose(bsdf.evaluate_specular(r, wo, wi), expected, rtol=1e-6)


def test_a_dielectric_of_refractive_index_1_is_lambertian() -> None:
    colour = (0.2, 0.4, 0.6)
    r = reflection(colour, 0.0, 0.3, 1.0)
    wo, wi = under(0.3), under(0.6)
    assert bsdf.is_lambertian(r)
    assert bsdf.specular_share(r, 0.3) == bsdf.specular_density(r, wo, wi) == 0.0
    assert bsdf.albedo(r, 0.3) == colour
    assert bsdf.evaluate_specular(r, wo, wi) == BLACK
    np.testing.assert_allclose(bsdf.evaluate_diffuse(r, wo[2], wi[2]), np.array(colour) * 0.6 / math.pi)


def test_a_metal_has_no_diffuse_lobe() -> None:
    r = reflection((0.9, 0.6, 0.3), 1.0, 0.5, 1.5)
    assert r.f0 == (0.9, 0.6, 0.3)
    assert bsdf.specular_share(r, 0.7) == 1.0
    assert bsdf.evaluate_diffuse(r, 0.7, 0.2) == BLACK


def test_a_metal_tints_light_once_for_each_hit() -> None:
    r = reflection((0.9, 0.6, 0.3), 1.0, 1.0, 1.5)
    found, mean = terms(0.7, r.alpha), mean_terms(r.alpha)
    for f0, share in zip(r.f0, bsdf.albedo(r, 0.7), strict=True):
        fresnel = f0 + (1.0 - f0) / 21.0
        inside, series = found.lost * fresnel, 0.0
        for _ in range(100):
            series += inside * fresnel * (1.0 - mean.lost)
            inside *= fresnel * mean.lost
        assert share == pytest.approx(f0 * (1.0 - found.lost - found.bias) + found.bias + series)


def test_a_dielectric_reflects_as_its_refractive_index_says() -> None:
    r = reflection((0.5, 0.5, 0.5), 0.0, 0.05, 1.5)
    np.testing.assert_allclose(r.f0, 0.04)
    # A smooth coat reflects f0 at normal incidence, nearly all at grazing incidence.
    np.testing.assert_allclose(bsdf.albedo(r, 1.0), 0.04 + 0.96 * 0.5, atol=1e-3)
    assert bsdf.specular_share(r, 1.0) == 0.1
    assert bsdf.specular_share(r, 0.02) > 0.7


@seeded
@given(reflections, directions, directions)
def test_nothing_comes_through_the_horizon(r: Reflection, wo: Vec3, wi: Vec3) -> None:
    below = (wi[0], wi[1], -wi[2])
    for a, b in ((wo, below), (below, wo)):
        assert bsdf.evaluate_diffuse(r, a[2], b[2]) == bsdf.evaluate_specular(r, a, b) == BLACK
    assert bsdf.diffuse_density(below[2]) == bsdf.specular_density(r, wo, below) == 0.0


def test_diffuse_samples_have_the_moments_of_the_cosine() -> None:
    drawn = np.array([bsdf.sample_diffuse(*u) for u in uniform(5000)])
    np.testing.assert_allclose(np.linalg.norm(drawn, axis=1), 1.0)
    np.testing.assert_allclose(drawn.mean(0), (0.0, 0.0, 2.0 / 3.0), atol=2e-3)
    np.testing.assert_allclose((drawn**2).mean(0), (0.25, 0.25, 0.5), atol=2e-3)


@seeded
@given(directions, st.floats(0.3, 3.0))
def test_glass_splits_light_as_fresnel_says(wo: Vec3, eta: float) -> None:
    wi, passes = bsdf.refract(wo, eta)
    reflected = bsdf.fresnel_dielectric(wo[2], eta)
    if not passes:
        assert math.hypot(wo[0], wo[1]) > eta * (1.0 - 1e-9)
        assert reflected == 1.0
        return
    assert wi[2] < 0.0
    np.testing.assert_allclose(np.linalg.norm(wi), 1.0)
    np.testing.assert_allclose(np.multiply(wi[:2], eta), np.negative(wo[:2]), atol=1e-12)
    # What passes, from the amplitudes: Born and Wolf, Principles of Optics, 1.5.2.
    cos_o, cos_i = wo[2], -wi[2]
    amplitudes = 2.0 * cos_o / (cos_o + eta * cos_i), 2.0 * cos_o / (eta * cos_o + cos_i)
    np.testing.assert_allclose(reflected + eta * cos_i / cos_o * np.square(amplitudes).mean(), 1.0, rtol=1e-6)


def test_glass_at_angles_known_from_books() -> None:
    np.testing.assert_allclose(bsdf.fresnel_dielectric(1.0, 1.5), 0.04)
    brewster = math.cos(math.atan(1.5))
    np.testing.assert_allclose(bsdf.fresnel_dielectric(brewster, 1.5), 0.5 * (1.25 / 3.25) ** 2)
    assert bsdf.fresnel_dielectric(0.5, 1.0 / 1.5) == 1.0
    assert not bsdf.refract(under(0.5), 1.0 / 1.5)[1]
    assert bsdf.fresnel_dielectric(0.5, 1.0) == 0.0
