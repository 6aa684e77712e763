"""How a surface scatters light: glTF's metallic-roughness model with conservation of energy, and smooth glass.

Directions are unit vectors that point away from the surface, in a frame whose third axis is the shading normal: `wo`
points to where the light goes, `wi` to where it comes from. Scattering functions include the cosine of `wi`.

The specular lobe is glTF's (GGX, height-correlated Smith shadowing, Schlick's Fresnel reflectance), with light added
for rays that hit the surface more than once. The diffuse lobe gets the light that the specular one does not reflect.
Both are reciprocal, and white surfaces reflect all light, apart from the error of the tables in `energy`.

Sources: Walter et al., Microfacet Models for Refraction through Rough Surfaces, 2007 (GGX); Heitz, Understanding the
Masking-Shadowing Function, JCGT 3 (2), 2014; Kulla and Conty, Revisiting Physically Based Shading at Imageworks, 2017
(multiple scattering), with the colour of Hill, A Multi-Faceted Exploration, 2018; Kelemen and Szirmay-Kalos, A
Microfacet Based Coupled Specular-Matte BRDF Model, 2001 (diffuse under a coat).
"""

from __future__ import annotations

import math
from typing import NamedTuple

from .compiled import compiled
from .energy import ALPHA_FLOOR, Terms, mean_terms, terms
from .sampling import on_circle
from .vec3 import Vec3, add, dot, luminance, multiply, normalise, scale

BLACK = (0.0, 0.0, 0.0)


class Reflection(NamedTuple):
    """The lobes of an opaque surface at one point.

    Attributes
    ----------
    diffuse : Vec3
        Reflectance of the surface under the coat; 0 for a metal.
    f0 : Vec3
        Reflectance of the coat at normal incidence. If it is 0, there is no coat, and the surface is Lambertian.
    alpha : float
        GGX width of the coat's lobe, ALPHA_FLOOR to 1.
    """

    diffuse: Vec3
    f0: Vec3
    alpha: float


@compiled
def reflection(base: Vec3, metallic: float, roughness: float, ior: float) -> Reflection:
    """The lobes of a `Material` whose colour at this point is `base`."""
    dielectric = ((ior - 1.0) / (ior + 1.0)) ** 2 * (1.0 - metallic)
    f0 = (dielectric + base[0] * metallic, dielectric + base[1] * metallic, dielectric + base[2] * metallic)
    return Reflection(scale(base, 1.0 - metallic), f0, max(roughness * roughness, ALPHA_FLOOR))


@compiled
def is_lambertian(r: Reflection) -> bool:
    """Whether the surface has no coat."""
    return max(r.f0[0], r.f0[1], r.f0[2]) <= 0.0


@compiled
def albedo(r: Reflection, cos_o: float) -> Vec3:
    """The share of the light arriving under the cosine `cos_o` that both lobes together reflect."""
    if is_lambertian(r):
        return r.diffuse
    coat = _coat_albedo(r.f0, terms(cos_o, r.alpha), mean_terms(r.alpha))
    return add(coat, multiply(r.diffuse, _complement(coat)))


@compiled
def specular_share(r: Reflection, cos_o: float) -> float:
    """The probability of sampling the specular lobe: its share of the albedo, 0.1..0.9 if both lobes exist."""
    if is_lambertian(r):
        return 0.0
    if luminance(r.diffuse) <= 0.0:
        return 1.0
    coat = _coat_albedo(r.f0, terms(cos_o, r.alpha), mean_terms(r.alpha))
    specular = luminance(coat)
    return min(max(specular / (specular + luminance(multiply(r.diffuse, _complement(coat)))), 0.1), 0.9)


@compiled
def evaluate_diffuse(r: Reflection, cos_o: float, cos_i: float) -> Vec3:
    """The diffuse lobe times `cos_i`, for the cosines of both directions; 0 below the horizon."""
    if cos_o <= 0.0 or cos_i <= 0.0 or luminance(r.diffuse) <= 0.0:
        return BLACK
    lambert = scale(r.diffuse, cos_i / math.pi)
    if is_lambertian(r):
        return lambert
    # Light passes through the coat on its way in and on its way out. Integrated over all directions, the product of
    # both shares is exactly the light that the coat does not reflect.
    o, i, mean = terms(cos_o, r.alpha), terms(cos_i, r.alpha), mean_terms(r.alpha)
    red, green, blue = _through(r.f0[0], o, i, mean), _through(r.f0[1], o, i, mean), _through(r.f0[2], o, i, mean)
    return multiply(lambert, (red, green, blue))


@compiled
def evaluate_specular(r: Reflection, wo: Vec3, wi: Vec3) -> Vec3:
    """The specular lobe times the cosine of `wi`; 0 below the horizon."""
    if wo[2] <= 0.0 or wi[2] <= 0.0 or is_lambertian(r):
        return BLACK
    half = add(wo, wi)
    # Shadowing and masking, with the Jacobian of the half vector and the cosine of `wi`.
    shadowing = 0.5 * wi[2] / (wi[2] * _smith(wo, r.alpha) + wo[2] * _smith(wi, r.alpha))
    once = _normals(half, r.alpha) * shadowing
    grazing = _fifth_power(1.0 - 0.5 * math.sqrt(dot(half, half)))
    mean = mean_terms(r.alpha)
    multiple = terms(wo[2], r.alpha).lost * terms(wi[2], r.alpha).lost / mean.lost * wi[2] / math.pi
    fresnel = (_mix(r.f0[0], grazing), _mix(r.f0[1], grazing), _mix(r.f0[2], grazing))
    return add(scale(fresnel, once), scale(_multiple_colour(r.f0, mean), multiple))


@compiled
def diffuse_density(cos_i: float) -> float:
    """Density of `sample_diffuse` per solid angle."""
    return max(cos_i, 0.0) / math.pi


@compiled
def sample_diffuse(u1: float, u2: float) -> Vec3:
    """A direction with the density of its cosine, for uniform numbers in [0, 1)."""
    radius, (cosine, sine) = math.sqrt(u1), on_circle(u2)
    return radius * cosine, radius * sine, math.sqrt(1.0 - u1)


@compiled
def specular_density(r: Reflection, wo: Vec3, wi: Vec3) -> float:
    """Density of `sample_specular` per solid angle; 0 below the horizon."""
    if wi[2] <= 0.0 or is_lambertian(r):
        return 0.0
    once = 0.5 * _normals(add(wo, wi), r.alpha) / (wo[2] + _smith(wo, r.alpha))
    return once + _multiple_share(r, wo[2]) * (_multiple_density(wi[2], r.alpha) - once)


@compiled
def sample_specular(r: Reflection, wo: Vec3, u1: float, u2: float) -> Vec3:
    """A direction of the specular lobe, for uniform numbers in [0, 1); a direction below the horizon has no light."""
    multiple = _multiple_share(r, wo[2])
    if u1 < multiple:
        return _sample_multiple(r.alpha, u1 / multiple, u2)
    normal = _sample_visible_normal(wo, r.alpha, (u1 - multiple) / (1.0 - multiple), u2)
    return add(scale(normal, 2.0 * dot(wo, normal)), scale(wo, -1.0))


@compiled
def fresnel_dielectric(cos_i: float, eta: float) -> float:
    """Reflectance of a smooth surface for unpolarised light.

    `eta` is the refractive index behind it divided by that in front.
    """
    squared = 1.0 - (1.0 - cos_i * cos_i) / (eta * eta)
    if squared <= 0.0:
        return 1.0
    cos_t = math.sqrt(squared)
    parallel = (eta * cos_i - cos_t) / (eta * cos_i + cos_t)
    perpendicular = (cos_i - eta * cos_t) / (cos_i + eta * cos_t)
    return 0.5 * (parallel * parallel + perpendicular * perpendicular)


@compiled
def refract(wo: Vec3, eta: float) -> tuple[Vec3, bool]:
    """The direction on the far side from which light that leaves along `wo` came, and whether it exists.

    It does not exist under total reflection. `eta` is as in `fresnel_dielectric`.
    """
    squared = 1.0 - (wo[0] * wo[0] + wo[1] * wo[1]) / (eta * eta)
    if squared <= 0.0:
        return BLACK, False
    return (-wo[0] / eta, -wo[1] / eta, -math.sqrt(squared)), True


@compiled
def _normals(half: Vec3, alpha: float) -> float:
    """GGX's density of normals along `half`, which may have any length.

    It uses the tangential part of `half`, because 1 - cosine^2 has no significant digits left for narrow lobes.
    """
    tangential = half[0] * half[0] + half[1] * half[1]
    upward = half[2] * half[2]
    spread = (tangential + upward) / (tangential / (alpha * alpha) + upward)
    return spread * spread / (math.pi * alpha * alpha)


@compiled
def _smith(w: Vec3, alpha: float) -> float:
    """Cosine * (1 + 2 Lambda), with Smith's Lambda for GGX, in a form that is also valid at the horizon."""
    return math.sqrt(w[2] * w[2] + alpha * alpha * (w[0] * w[0] + w[1] * w[1]))


@compiled
def _sample_visible_normal(wo: Vec3, alpha: float, u1: float, u2: float) -> Vec3:
    """A normal, sampled with the density of normals visible from `wo`.

    Source: Dupuy and Benyoub, Sampling Visible GGX Normals with Spherical Caps, HPG 2023, listing 3.
    """
    stretched = normalise((alpha * wo[0], alpha * wo[1], wo[2]))
    below = u1 * (1.0 + stretched[2])
    radius, (cosine, sine) = math.sqrt(below * (2.0 - below)), on_circle(u2)
    x, y = radius * cosine + stretched[0], radius * sine + stretched[1]
    return normalise((alpha * x, alpha * y, 1.0 - below + stretched[2]))


@compiled
def _multiple_share(r: Reflection, cos_o: float) -> float:
    """The part of the specular lobe's albedo that comes from light that hits the surface several times."""
    found, mean = terms(cos_o, r.alpha), mean_terms(r.alpha)
    brightest = max(r.f0[0], r.f0[1], r.f0[2])
    return _multiple(brightest, mean) * found.lost / _coat(brightest, found, mean)


@compiled
def _sample_multiple(alpha: float, u1: float, u2: float) -> Vec3:
    """A direction with a density like the light lost to single scattering: c / (c^2 + alpha^2), c its cosine."""
    cosine = alpha * math.sqrt(math.expm1(u1 * math.log1p(1.0 / (alpha * alpha))))
    radius, (x, y) = math.sqrt(max(1.0 - cosine * cosine, 0.0)), on_circle(u2)
    return radius * x, radius * y, cosine


@compiled
def _multiple_density(cosine: float, alpha: float) -> float:
    """Density of `_sample_multiple` per solid angle."""
    return cosine / ((cosine * cosine + alpha * alpha) * math.pi * math.log1p(1.0 / (alpha * alpha)))


@compiled
def _coat_albedo(f0: Vec3, found: Terms, mean: Terms) -> Vec3:
    """The albedo of the specular lobe; `found` are its terms, and `mean` their mean over the hemisphere."""
    return _coat(f0[0], found, mean), _coat(f0[1], found, mean), _coat(f0[2], found, mean)


@compiled
def _coat(f0: float, found: Terms, mean: Terms) -> float:
    """One channel of `_coat_albedo`: the light of a single hit and of several hits."""
    return f0 * (1.0 - found.lost - found.bias) + found.bias + _multiple(f0, mean) * found.lost


@compiled
def _through(f0: float, o: Terms, i: Terms, mean: Terms) -> float:
    """One channel of the light that passes the coat both ways, divided by the mean for one way."""
    through = (1.0 - _coat(f0, o, mean)) * (1.0 - _coat(f0, i, mean))
    return through / max(1.0 - _coat(f0, mean, mean), 1e-9)


@compiled
def _multiple_colour(f0: Vec3, mean: Terms) -> Vec3:
    """The share of the light lost to single scattering that leaves the surface after further hits."""
    return _multiple(f0[0], mean), _multiple(f0[1], mean), _multiple(f0[2], mean)


@compiled
def _multiple(f0: float, mean: Terms) -> float:
    """One channel of `_multiple_colour`.

    It is a geometric series: each hit reflects Fresnel's mean, of which the share 1 - lost leaves the surface.
    """
    fresnel = _mix(f0, 1.0 / 21.0)
    return fresnel * fresnel * (1.0 - mean.lost) / (1.0 - fresnel * mean.lost)


@compiled
def _mix(f0: float, grazing: float) -> float:
    """Schlick's reflectance; the mean of `grazing` = (1 - cosine)^5 over the hemisphere is 1 / 21."""
    return f0 + (1.0 - f0) * grazing


@compiled
def _fifth_power(x: float) -> float:
    squared = x * x
    return squared * squared * x


@compiled
def _complement(colour: Vec3) -> Vec3:
    """1 - colour: the light that is not reflected."""
    return 1.0 - colour[0], 1.0 - colour[1], 1.0 - colour[2]
