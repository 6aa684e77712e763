"""Footage is what it says: noisy frames, and two independent halves of the truth about part of the last two."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from benchmarks.footage import FOOTAGE, Footage
from svgf_cl.io import cache
from svgf_cl_tracer import Camera

SMALL = Footage("small", jitter=True, shape=(30, 40), band=(0.5, 0.7), frames=3, spp=64)


@pytest.fixture(autouse=True)
def _kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cache, "cache_folder", lambda: tmp_path)


def test_each_judged_frame_has_two_independent_halves_of_its_rows() -> None:
    halves = SMALL.halves(lambda: None)
    assert (SMALL.judged, SMALL.rows) == (range(1, 3), (15, 21))
    assert np.shape(halves) == (2, 2, 6, 40, 3)
    pictures = [picture for pair in halves for picture in pair]
    assert len({picture.tobytes() for picture in pictures}) == 4
    whole = [frame.color[15:21].mean() for frame in SMALL.noisy()][1:]
    np.testing.assert_allclose([np.mean(pair) for pair in halves], whole, rtol=0.2)


def test_progress_adds_up_and_the_truth_is_kept(tmp_path: Path) -> None:
    ticks: list[None] = []
    first = SMALL.halves(lambda: ticks.append(None))
    files = {path: path.stat().st_mtime_ns for path in tmp_path.rglob("*.npz")}
    np.testing.assert_array_equal(SMALL.halves(lambda: ticks.append(None)), first)
    assert {path: path.stat().st_mtime_ns for path in tmp_path.rglob("*.npz")} == files
    assert len(ticks) == 2 * SMALL.chunks == 16


def test_without_jitter_the_truth_is_another() -> None:
    area, centre = (replace(SMALL, jitter=jitter).halves(lambda: None) for jitter in (True, False))
    assert not np.allclose(area, centre, rtol=0.01)


def test_the_camera_goes_where_it_is_sent() -> None:
    away = replace(SMALL, cameras=(Camera((0, 1, 3), (0, 1, 9)),), jitter=False)
    assert all(np.isinf(frame.depth).all() for frame in away.noisy())
    assert not np.any(away.halves(lambda: None))


def test_the_footage_comes_with_jitter_and_without() -> None:
    assert [(each.name, each.jitter) for each in FOOTAGE] == [("area", True), ("centre", False)]
    assert all(each.spp >= 512 for each in FOOTAGE)
