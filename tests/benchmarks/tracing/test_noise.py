"""The error beside the speed is that of one sample per pixel, whatever the reference has."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.tracing.noise import noise
from svgf_cl.compare.metrics import relmse
from svgf_cl_tracer import References, Shot, render_frame


def test_error_of_one_sample(shot: Shot) -> None:
    ticks: list[int] = []
    found = noise(shot, 3, 256, lambda: ticks.append(1))
    assert len(ticks) == 16
    references = References(shot, jitter=False)
    truth = references.picture(references.render(3, 256))
    frames = [render_frame(shot, 3, seed=seed, jitter=False).color for seed in range(1, 101)]
    assert found["relmse"] == pytest.approx(np.mean([relmse(frame, truth) for frame in frames]), rel=0.1)
    assert 5.0 < found["psnr"] < 40.0
