"""Footage keeps its truth, and only for what it was rendered with."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from benchmarks import footage
from benchmarks.footage import FOOTAGE, PART, Footage
from tracer import Camera

SMALL = Footage("small", jitter=True, shape=(30, 40), band=(0.5, 0.7), frames=3, spp=2 * PART)


@pytest.fixture(autouse=True)
def _cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(footage, "cache_folder", lambda: tmp_path)


def test_each_judged_frame_has_two_independent_halves_of_its_rows() -> None:
    halves = SMALL.halves(lambda: None)
    assert (SMALL.judged, SMALL.rows) == ((1, 2), (15, 21))
    assert np.shape(halves) == (2, 2, 6, 40, 3)
    pictures = [picture for pair in halves for picture in pair]
    assert len({picture.tobytes() for picture in pictures}) == 4
    whole = [frame.color[15:21].mean() for frame in SMALL.noisy()][1:]
    np.testing.assert_allclose([np.mean(pair) for pair in halves], whole, rtol=0.2)


def test_the_truth_is_rendered_once() -> None:
    ticks: list[None] = []
    assert SMALL.parts_to_render == 4
    first = SMALL.halves(lambda: ticks.append(None))
    assert len(ticks) == 4
    assert SMALL.parts_to_render == 0
    np.testing.assert_array_equal(SMALL.halves(lambda: ticks.append(None)), first)
    assert len(ticks) == 4


def test_what_is_missing_is_rendered_again() -> None:
    SMALL.halves(lambda: None)
    next(iter(SMALL.folder.iterdir())).unlink()
    assert SMALL.parts_to_render == 1
    assert len(SMALL.halves(lambda: None)) == 2


@pytest.mark.parametrize(
    "change",
    [
        {"jitter": False},
        {"scene": "other.glb"},
        {"cameras": (Camera((0, 0, 0), (0, 0, 1)),)},
        {"sky": (1.0, 1.0, 1.0)},
        {"shape": (30, 41)},
        {"band": (0.5, 0.8)},
        {"frames": 4},
        {"spp": 4 * PART},
    ],
)
def test_other_parameters_have_another_truth(change: dict[str, Any]) -> None:
    assert replace(SMALL, **change).folder != SMALL.folder
    assert replace(SMALL).folder == SMALL.folder


def test_another_scene_of_that_name_has_another_truth(tmp_path: Path) -> None:
    scene = tmp_path / "scene.glb"
    scene.write_bytes(b"one")
    before = replace(SMALL, scene=str(scene)).folder
    scene.write_bytes(b"two")
    assert replace(SMALL, scene=str(scene)).folder != before


def test_the_camera_goes_where_it_is_sent() -> None:
    away = replace(SMALL, cameras=(Camera((0, 1, 3), (0, 1, 9)),), jitter=False)
    assert all(np.isinf(frame.depth).all() for frame in away.noisy())
    assert not np.any(away.halves(lambda: None))


def test_another_tracer_has_another_truth(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    before = SMALL.folder
    (tmp_path / "__init__.py").write_text("a changed tracer")
    monkeypatch.setattr(footage.tracer, "__file__", str(tmp_path / "__init__.py"))
    assert SMALL.folder != before


def test_the_footage_comes_with_jitter_and_without() -> None:
    assert [(each.name, each.jitter) for each in FOOTAGE] == [("area", True), ("centre", False)]
    assert all(each.spp >= 512 for each in FOOTAGE)
