"""The error beside every speed is over the whole sequence."""

from __future__ import annotations

import numpy as np
import pyopencl as cl
import pytest

from svgf_cl import Settings
from svgf_cl.bench import error


@pytest.mark.parametrize("signals", [1, 2])
def test_the_filter_is_close_to_the_oracle(queue: cl.CommandQueue, signals: int) -> None:
    worst, rms = error.error_to_oracle(Settings(), signals=signals, frames=2, queue=queue)
    assert 0 < rms < worst < 1e-3


def test_errors_are_over_all_frames(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each frame is off by another amount; the last one, by the least, does not hide the others."""
    amounts = iter((0.3, 0.4, 0.0))

    class Off:
        def __init__(self, *_: object, **__: object) -> None: ...

        def denoise(self, _: object) -> np.ndarray:
            return np.full((*error.ERROR_SHAPE, 3), 2 * (1 + next(amounts)))

    class Truth(Off):
        def denoise(self, _: object) -> np.ndarray:
            return np.full((*error.ERROR_SHAPE, 3), 2.0)

    monkeypatch.setattr(error, "Denoiser", Off)
    monkeypatch.setattr(error, "oracle_of", Truth)
    worst, rms = error.error_to_oracle(Settings(), frames=3)
    assert worst == pytest.approx(0.4)
    assert rms == pytest.approx((0.25 / 3) ** 0.5)
