"""A longer warm-up makes a smaller join, and the table says so."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

pytest.importorskip("flip_evaluator")
from benchmarks.joins import COLUMNS, WARM_UPS, last_two, rms, rows_of
from svgf_cl.io.synthetic import room_frames

FRAMES = list(room_frames((36, 64), max(WARM_UPS) + 4))


def test_the_rows_of_a_scene() -> None:
    half = np.asarray(FRAMES[-1].albedo)
    footage = SimpleNamespace(name="room", frames=lambda: FRAMES, truths=lambda advance: {35: (half, half)})
    steps: list[int] = []
    rows = list(rows_of(footage, lambda: steps.append(1)))
    assert len(steps) == 1 + len(WARM_UPS)
    assert all(len(row) == len(COLUMNS) for row in rows)
    assert [row[:2] for row in rows] == [["room", str(warm_up)] for warm_up in WARM_UPS]
    decibels = [float(row[2]) for row in rows]
    assert decibels == sorted(decibels)
    assert decibels[-1] > decibels[0] + 20
    shares = [float(row[4]) for row in rows]
    assert shares == sorted(shares, reverse=True)


def test_a_chunk_that_is_the_whole_shot_has_no_join() -> None:
    assert rms(last_two(FRAMES)[-1], last_two(list(FRAMES))[-1]) == 0.0
    assert len(last_two(FRAMES[-1:])) == 1
