"""modulate.cl: what comes in is made safe, and texture and emission stay out of the filter."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from svgf_cl import Frame
from svgf_cl.device.layout import HALO, Layout
from tests.denoising import feed
from tests.frames import FULL, SHAPE, SPLIT, noise, only, wall

HUGE = np.finfo(np.float32).max


def full_wall(**given: Any) -> Frame:
    """A wall with every field of one signal."""
    return only(wall(**({"albedo": 1.0, "emission": 0.0, "id": 1} | given)), FULL)


def test_texture_is_not_filtered() -> None:
    albedo = 0.05 + 0.95 * noise()
    out, _ = feed(full_wall(color=0.5 * albedo, albedo=albedo))
    assert_allclose(out, 0.5 * albedo, rtol=1e-6)


def test_emission_is_not_filtered() -> None:
    emission = noise()
    out, _ = feed(full_wall(color=0.25 + emission, emission=emission))
    assert_allclose(out, 0.25 + emission, rtol=1e-6)


def test_light_on_black_survives() -> None:
    assert_allclose(feed(full_wall(color=0.25, albedo=0.0))[0], 0.25, rtol=1e-6)


def test_more_emission_than_light_leaves_no_negative_light() -> None:
    out, den = feed(full_wall(color=0.25, emission=(1.0, 0.0, 0.0)))
    assert_array_equal(den.stage("demodulated")[..., 0], 0)
    assert_allclose(out[..., 0], 1, rtol=1e-6)


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_one_bad_channel_blackens_the_colour(bad: float) -> None:
    assert_array_equal(feed(wall(color=(1.0, bad, 1.0)))[1].stage("demodulated"), 0)


@pytest.mark.parametrize("bad", [np.nan, np.inf, 1e30])
def test_bad_albedo_is_white(bad: float) -> None:
    out, den = feed(full_wall(color=0.25, albedo=(1.0, bad, 0.5)))
    assert_allclose(den.stage("demodulated")[0, 0, 0], (0.25, 0.25, 0.5), rtol=1e-6)
    assert_allclose(out, 0.25, rtol=1e-6)


@pytest.mark.parametrize("normal", [(0.0, 3.0, 4.0), (0.0, 3e-5, 4e-5), (0.0, 3e9, 4e9)])
def test_normals_become_unit(normal: tuple[float, ...]) -> None:
    assert_allclose(feed(wall(normal=normal))[1].stage("normal")[0, 0], (0, 0.6, 0.8), rtol=1e-6)


@pytest.mark.parametrize(
    "changes",
    [{"depth": np.inf}, {"depth": np.nan}, {"depth": 0}, {"depth": -1}, {"normal": 0}, {"normal": (np.nan, 0, 1)}],
    ids=str,
)
def test_miss_has_no_surface(changes: dict[str, Any]) -> None:
    _, den = feed(wall(**changes))
    assert_array_equal(den.stage("normal"), 0)
    assert_array_equal(den.stage("depth"), 0)


@pytest.mark.parametrize("taa", [False, True])
def test_nothing_overflows(taa: bool) -> None:
    y, x = np.indices(SHAPE)
    albedo = np.where((x + y) % 2, HUGE, 1)[..., None]
    bright = wall(direct=10.0, indirect=10.0, albedo=albedo, emission=HUGE, id=1)
    out, den = feed(only(bright, SPLIT), taa=taa)
    assert np.isfinite(out).all()
    assert all(np.isfinite(den.stage(name)).all() for name in den.stages)


def test_nothing_is_seen_outside_the_image() -> None:
    _, den = feed(wall())
    surface = den.raw_stage("depth").reshape(-1, Layout(*SHAPE).rows, Layout(*SHAPE).pitch)
    surface[:, HALO : HALO + SHAPE[0], HALO : HALO + SHAPE[1]] = 0
    assert not surface.any()
