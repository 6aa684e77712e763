"""The parts of the shading loop do what the loop does: as many random numbers, textures and lights."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.tracing.loops import Spots, draw_numbers, read_textures, sample_lights
from benchmarks.tracing.recording import Recording, Shading, record
from benchmarks.tracing.split import spots
from svgf_cl_tracer import Shot, builtin_scene
from svgf_cl_tracer.light_sampling import outside_radiance
from svgf_cl_tracer.materials import base_colour
from svgf_cl_tracer.sampling import random4
from svgf_cl_tracer.shading import FIRST_SURFACE_DRAW
from svgf_cl_tracer.trees import MISS


@pytest.fixture(params=[0, 1, 2])
def call(request: pytest.FixtureRequest, recording: Recording) -> Shading:
    """The loop after 0, 1 and 2 surfaces."""
    return recording.shadings[request.param]


def test_where_paths_are(call: Shading) -> None:
    found = spots(call)
    hit = call.hits.triangle != MISS
    np.testing.assert_array_equal(found.material != MISS, hit)
    materials = call.tables.triangles.material[call.hits.triangle[hit]]
    np.testing.assert_array_equal(found.material[hit], materials)
    np.testing.assert_array_equal(found.goes_on, hit & (call.paths.scatterings > 0))
    np.testing.assert_array_equal(found.lit, found.goes_on, "a box with a lamp and without glass")
    travelled = call.paths.origin + call.hits.distance[:, None] * call.paths.direction
    np.testing.assert_allclose(found.origin[hit], travelled[hit], atol=1e-3)


def test_random_numbers(call: Shading) -> None:
    found, draws = spots(call), call.draws
    drawn = [
        random4(draws.key, draws.pixels[pixel], draws.sample, FIRST_SURFACE_DRAW + 2 * call.depth + place)
        for pixel in call.paths.pixel[found.goes_on]
        for place in (0, 1)
    ]
    assert draw_numbers(draws, call.depth, call.paths, found) == pytest.approx(np.sum(drawn))
    np.testing.assert_array_equal(found.numbers[found.lit], np.reshape(drawn, (-1, 4))[1::2])


def test_textures(call: Shading) -> None:
    found, materials = spots(call), call.tables.materials
    colours = [
        base_colour(materials, material, u, v)
        for material, u, v, goes_on in zip(found.material, found.u, found.v, found.goes_on, strict=True)
        if goes_on
    ]
    emission = materials.emission[found.material[found.material != MISS]]
    assert read_textures(call.tables, found) == pytest.approx(np.sum(colours) + emission.sum(), rel=1e-6)


def test_no_light_from_where_none_is_sampled(call: Shading) -> None:
    found = spots(call)
    dark = found._replace(lit=np.zeros_like(found.lit), material=np.zeros_like(found.material))
    assert sample_lights(call.tables, call.paths, dark) == 0.0
    assert (sample_lights(call.tables, call.paths, found) > 0.0) == found.lit.any()


def test_the_sky_is_counted_where_paths_leave() -> None:
    call = record(Shot(builtin_scene("fence"), (18, 32), 24), 3).shadings[0]
    missed = call.hits.triangle == MISS
    assert missed.any()
    sky = [
        outside_radiance(call.tables.lights, call.tables.sky, tuple(map(float, direction)), 0.0)
        for direction in call.paths.direction[missed]
    ]
    found = spots(call)
    only_sky = found._replace(lit=np.zeros_like(found.lit))
    assert sample_lights(call.tables, call.paths, only_sky) == pytest.approx(np.sum(sky), rel=1e-6)


def test_room() -> None:
    assert {len(values) for values in Spots.empty(7)} == {7}
