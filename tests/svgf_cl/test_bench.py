"""The benchmark's figures mean what they say."""

from __future__ import annotations

import numpy as np
import pyopencl as cl
import pytest

from svgf_cl import Denoiser, Settings, bench

SMALL = (9, 16)


def test_timings_are_percentiles() -> None:
    timing = bench.Timing.of("pass", [float(n) for n in range(101)])
    assert (timing.name, timing.low, timing.median, timing.high) == ("pass", 10, 50, 90)


@pytest.mark.parametrize("signals", [1, 2])
def test_every_pass_is_timed_then_the_device_then_the_frame(queue: cl.CommandQueue, signals: int) -> None:
    den = Denoiser(SMALL, queue=queue)
    ticks: list[None] = []
    timings = bench.measure(den, 3, signals=signals, advance=lambda: ticks.append(None))
    assert [timing.name for timing in timings] == [*den.profile(), "device", "frame"]
    assert len(ticks) == 3
    assert all(0 < timing.low <= timing.median <= timing.high for timing in timings)


@pytest.mark.parametrize("signals", [1, 2])
def test_the_filter_is_close_to_the_oracle(queue: cl.CommandQueue, signals: int) -> None:
    worst, rms = bench.error_to_oracle(Settings(), signals=signals, frames=2, queue=queue)
    assert 0 < rms < worst < 1e-3


def test_errors_are_over_all_frames(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each frame is off by another amount; the last one, by the least, does not hide the others."""
    amounts = iter((0.3, 0.4, 0.0))

    class Off:
        def __init__(self, *_: object, **__: object) -> None: ...

        def denoise(self, _: object) -> np.ndarray:
            return np.full((*bench.ERROR_SHAPE, 3), 2 * (1 + next(amounts)))

    class Truth(Off):
        def denoise(self, _: object) -> np.ndarray:
            return np.full((*bench.ERROR_SHAPE, 3), 2.0)

    monkeypatch.setattr(bench, "Denoiser", Off)
    monkeypatch.setattr(bench, "Reference", Truth)
    worst, rms = bench.error_to_oracle(Settings(), frames=3)
    assert worst == pytest.approx(0.4)
    assert rms == pytest.approx((0.25 / 3) ** 0.5)
