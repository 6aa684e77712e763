"""All rivals see the same frames, all of them, and are judged where there is a truth."""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("flip_evaluator")
pytest.importorskip("skimage")

from benchmarks import contest
from benchmarks.footage import Footage
from benchmarks.rivals import Rival
from svgf_cl import Frame

FOOTAGE = Footage("centre", jitter=False, scene="swing", shape=(32, 48), band=(0, 1), frames=5, last=3, spp=32)


class Fixed:
    """Makes the same picture of every frame, and keeps the frames."""

    def __init__(self, level: float) -> None:
        self.level = level
        self.seen: list[Frame] = []

    def denoise(self, frame: Frame) -> np.ndarray:
        self.seen.append(frame)
        return np.full((*frame.shape, 3), self.level, np.float32)


def test_every_frame_is_seen_and_the_last_are_judged() -> None:
    dark, grey = Fixed(0.0), Fixed(0.2)
    ticks: list[None] = []
    steps = FOOTAGE.chunks + FOOTAGE.frames
    found, pictures = contest.compete(
        FOOTAGE, {"dark": Rival(dark), "grey": Rival(grey)}, [3], lambda: ticks.append(None)
    )
    assert len(ticks) == steps
    assert len(dark.seen) == 5
    assert all(one is other for one, other in zip(dark.seen, grey.seen, strict=True))
    assert dark.seen[0].direct is None
    assert (found.scene, found.frames) == ("swing", range(2, 5))
    assert found.rows["dark"].findings.bias == -1
    assert found.rows["dark"].call is found.rows["dark"].device is None
    assert found.rows["grey"].findings.psnr > found.rows["dark"].findings.psnr
    assert list(pictures) == [3]
    assert list(pictures[3]) == ["dark", "grey", contest.TRUTH]
    halves = FOOTAGE.halves(lambda: None)
    np.testing.assert_allclose(pictures[3][contest.TRUTH], np.mean(halves[1], axis=0))
    assert 10 < found.truth_noise < 40
