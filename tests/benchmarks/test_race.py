"""Every denoiser has its turn in every round, and ratios are those of one round."""

from __future__ import annotations

import pyopencl as cl
import pytest

from benchmarks import race
from benchmarks.oidn import Images
from benchmarks.race import DEVICE, WHOLE, Spread
from svgf_cl import Denoiser
from svgf_cl.room import PERIOD, room_frames

SHAPE = (9, 16)


class Rival:
    """Stands for a filter of Open Image Denoise: notes its turns and what it was given."""

    def __init__(self, name: str, images: Images, turns: list[tuple[str, float]]) -> None:
        self.name, self.images, self.turns = name, images, turns

    def execute(self) -> None:
        self.turns.append((self.name, float(self.images.color.sum())))

    def check(self) -> None: ...


def test_spread_is_percentiles() -> None:
    spread = Spread.of([float(n) for n in range(101)])
    assert spread == Spread(median=50, low=10, high=90)
    assert f"{spread:.1f}" == "50.0 (10.0-90.0)"


def test_ratios_are_paired() -> None:
    """A machine that is three times slower in some rounds is so for both; their ratio does not notice."""
    assert race.ratio([20.0, 60.0, 20.0], [10.0, 30.0, 10.0]) == Spread(2.0, 2.0, 2.0)


def test_all_take_turns_on_the_same_frame(queue: cl.CommandQueue) -> None:
    rounds = PERIOD + 1
    images, turns, ticks = Images(SHAPE), [], []
    rivals = {name: Rival(name, images, turns) for name in "ab"}
    times = race.race(Denoiser(SHAPE, queue=queue), images, rivals, rounds, lambda: ticks.append(None))
    assert list(times) == [WHOLE, DEVICE, "a", "b"]
    assert {len(samples) for samples in times.values()} == {len(ticks)} == {rounds}
    light = [float(frame.color.sum()) for frame in room_frames(SHAPE, PERIOD)]
    assert turns == [(name, light[n % PERIOD]) for n in range(rounds) for name in "ab"]


def test_a_time_covers_its_own_turn_only(queue: cl.CommandQueue, monkeypatch: pytest.MonkeyPatch) -> None:
    """Whole milliseconds from a clock that only the denoisers move; the device's own times are not of this clock."""
    now = [0.0]
    monkeypatch.setattr(race.time, "perf_counter", lambda: now[0])

    class Slow(Denoiser):
        def denoise(self, *args, **kwargs):
            now[0] += 1e-3
            return super().denoise(*args, **kwargs)

    class SlowRival(Rival):
        def execute(self) -> None:
            now[0] += 5e-3

    def advance() -> None:
        now[0] += 100.0

    images = Images(SHAPE)
    times = race.race(Slow(SHAPE, queue=queue), images, {"a": SlowRival("a", images, [])}, 2, advance)
    assert times[WHOLE] == pytest.approx([1, 1])
    assert times["a"] == pytest.approx([5, 5])
