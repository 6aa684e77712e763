"""The comparison of filters: every one is judged, and sharpness is what it says."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import typer
from typer.testing import CliRunner

pytest.importorskip("flip_evaluator")
pytest.importorskip("skimage")

from benchmarks import filters
from svgf_cl import Denoiser, Eaw, Frame
from svgf_cl.io.synthetic import room_frames

APP = typer.Typer()
APP.command()(filters.filters)

EDGE = np.repeat(np.arange(16)[None, :, None] >= 8, 16, axis=0) * np.ones(3)
EVERYWHERE = np.ones((16, 16), np.bool_)


def test_every_filter_is_judged_and_pictures_are_written(tmp_path: Path) -> None:
    arguments = ["swing", "--size", "48x32", "--frames", "3", "--spp", "32", "-o", str(tmp_path), "--markdown"]
    run = CliRunner().invoke(APP, arguments, catch_exceptions=False)
    assert run.exit_code == 0
    rows = [line.split(" | ")[0].removeprefix("| ") for line in run.output.splitlines() if line.startswith("| ")]
    assert rows == ["filter", "---", "noisy", "accumulated", "EAW", "SVGF", "EAW, TAA", "SVGF, TAA"]
    assert "truth: 32 spp" in run.output
    assert [path.name for path in tmp_path.iterdir()] == ["swing.png"]


def test_each_tolerance_is_a_row() -> None:
    chosen = filters.compared_filters([Eaw(sigma_color=0.5), Eaw(sigma_color=2.0)])
    assert list(chosen) == ["EAW 0.5", "EAW 2", "SVGF", "EAW 0.5, TAA", "EAW 2, TAA", "SVGF, TAA"]
    assert [getattr(each, "taa") for each in chosen.values()] == [False] * 3 + [True] * 3  # noqa: B009  # not of all


def test_a_copy_is_as_sharp_and_half_the_contrast_half_as_sharp() -> None:
    assert filters.sharpness(EDGE, EDGE, EVERYWHERE) == pytest.approx(1)
    assert filters.sharpness(0.5 * EDGE + 0.2, EDGE, EVERYWHERE) == pytest.approx(0.5)
    assert filters.sharpness(np.full_like(EDGE, 0.5), EDGE, EVERYWHERE) == 0


def test_noise_is_no_sharpness() -> None:
    edge = np.repeat(np.arange(200)[None, :, None] >= 100, 200, axis=0) * np.ones(3)
    noise = np.random.default_rng(0).normal(0, 0.5, edge.shape)
    assert filters.sharpness(edge + noise, edge, np.ones(edge.shape[:2], np.bool_)) == pytest.approx(1, abs=0.1)


def test_edges_are_looked_for_where_they_are_asked_for() -> None:
    left = EVERYWHERE & (np.arange(16) < 4)
    assert np.isnan(filters.sharpness(EDGE, EDGE, left))
    assert np.isnan(filters.sharpness(EDGE, EDGE, np.zeros_like(left)))


def test_flicker_counts_on_surfaces_alone() -> None:
    still, left = np.zeros((4, 4, 3)), np.repeat(np.arange(4)[None] < 2, 4, axis=0)
    moved = np.where(left[..., None], 0.25, 1.0)
    truth = ((still, still), (still, still))
    assert filters.flicker((still, moved), truth, left) == pytest.approx(0.25)
    assert np.isnan(filters.flicker((still, moved), truth, left & ~left))


def test_noise_of_the_truth_is_no_flicker() -> None:
    rng = np.random.default_rng(0)
    still = np.zeros((100, 100, 3))
    first, second = ((rng.normal(0, 0.1, still.shape), rng.normal(0, 0.1, still.shape)) for _ in range(2))
    moved = still + 0.05
    found = filters.flicker((still, moved), (first, second), np.ones((100, 100), np.bool_))
    assert found == pytest.approx(0.05, rel=0.1)


def test_the_gradient_is_that_of_luminance() -> None:
    y, x = np.indices((8, 9))
    ramp = (0.1 * x + 0.02 * y)[..., None] * np.ones(3)
    np.testing.assert_allclose(filters.gradient(ramp)[1:-1, 1:-1], np.broadcast_to((0.1, 0.02), (6, 7, 2)))


def test_one_surface_ends_where_anything_but_light_changes() -> None:
    shape = (9, 12)
    plain = {
        "color": np.random.default_rng(0).random((*shape, 3)),
        "normal": np.broadcast_to((0.0, 0.0, 1.0), (*shape, 3)),
        "depth": np.full(shape, 3.0),
        "motion": np.zeros((*shape, 2)),
        "albedo": np.full((*shape, 3), 0.5),
        "id": np.ones(shape, np.uint32),
    }
    inside = filters.one_surface(Frame(**plain))
    assert inside[2:-2, 2:-2].all()
    assert inside.sum() == 5 * 8
    right = np.arange(12) >= 6
    for name, other in (("normal", (1.0, 0.0, 0.0)), ("depth", np.inf), ("albedo", 0.6), ("id", 2)):
        there = right.reshape(1, 12, *[1] * (plain[name].ndim - 2))
        split = Frame(**plain | {name: np.where(there, other, plain[name]).astype(plain[name].dtype)})
        assert not filters.one_surface(split)[:, 5].any(), name


def test_accumulation_alone_is_what_comes_in_on_the_first_frame() -> None:
    (frame,) = room_frames((40, 64), 1)
    den = Denoiser((40, 64), settings=Eaw())
    den.denoise(frame)
    np.testing.assert_allclose(filters.accumulated(den, frame), frame.color, rtol=1e-4, atol=1e-5)
