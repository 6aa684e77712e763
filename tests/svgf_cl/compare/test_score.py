"""One picture's figures, and what becomes of it in the next."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("flip_evaluator")
pytest.importorskip("skimage")

from svgf_cl.compare.score import Change, Score, Sight
from svgf_cl.compare.share import Share
from svgf_cl.compare.view import View
from svgf_cl.io.display import display
from tests.frames import wall

SHAPE = (16, 24)
TRUTH = 0.2 + 0.6 * np.random.default_rng(0).random((*SHAPE, 3))
BEFORE = View(wall(SHAPE, id=1), (TRUTH, TRUTH), jitter=False)
NOW = View(wall(SHAPE, id=1), (TRUTH, TRUTH), jitter=False, earlier=(BEFORE.frame, BEFORE.halves))


def test_the_truth_scores_best() -> None:
    score = Score.of(Sight(TRUTH, NOW))
    assert (score.ssim, score.flip, score.relmse, score.relmse_trimmed, score.error.value) == (1, 0, 0, 0, 0)
    assert score.brightness.value == score.edges.value == pytest.approx(1)
    assert score.detail == score.unsettled == Share()


def test_a_picture_is_measured_by_what_is_wrong_with_it() -> None:
    score = Score.of(Sight(0.5 * TRUTH, NOW))
    assert score.brightness.value == pytest.approx(0.5)
    assert score.relmse == pytest.approx(np.mean((0.5 * TRUTH) ** 2 / (TRUTH**2 + 0.01)))
    assert score.relmse_trimmed < score.relmse
    assert score.edges.value < 1


def test_a_change_is_measured_where_the_surface_was() -> None:
    change = Change.of(Sight(TRUTH, BEFORE), Sight(np.zeros_like(TRUTH), NOW))
    shown = Sight(TRUTH, NOW).shown
    assert change.everywhere.value == change.warped.value == pytest.approx(np.mean(shown**2))
    assert change.warped_truth.value == 0


def test_where_the_frame_before_is_not_known_nothing_is_warped() -> None:
    change = Change.of(Sight(TRUTH, BEFORE), Sight(TRUTH, BEFORE))
    assert change.everywhere.value == 0
    assert change.warped == change.warped_truth == Share()


def test_light_is_measured_as_it_is_and_the_rest_as_shown() -> None:
    usual, dark = (Score.of(Sight(0.5 * TRUTH, replace(NOW, exposure=stops))) for stops in (0.0, -4.0))
    assert (dark.relmse, dark.relmse_trimmed, dark.brightness) == (usual.relmse, usual.relmse_trimmed, usual.brightness)
    expected = np.mean((display(TRUTH / 16) - display(TRUTH / 32)) ** 2)
    assert dark.error.value == pytest.approx(expected)
    assert dark.error.value < 0.5 * usual.error.value
