"""Every denoiser has its turn in every round, and ratios are those of one round."""

from __future__ import annotations

import pyopencl as cl
import pytest

from benchmarks import race
from benchmarks.race import Spread
from svgf_cl import Denoiser, Frame
from svgf_cl.bench.rig import EVENT, HOST
from svgf_cl.io.synthetic import PERIOD, room_frames

SHAPE = (9, 16)


class Rival:
    """Stands for a filter of Open Image Denoise: notes its turns and what it was given."""

    def __init__(self, name: str, turns: list[tuple[str, float]]) -> None:
        self.name, self.turns, self.light = name, turns, 0.0

    def load(self, frame: Frame) -> None:
        self.light = float(frame.color.sum())

    def execute(self) -> None:
        self.turns.append((self.name, self.light))

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
    turns, ticks = [], []
    rivals = {name: Rival(name, turns) for name in "ab"}
    own = {name: Denoiser(SHAPE, queue=queue) for name in ("one", "two")}
    times = race.race(own, rivals, rounds, lambda: ticks.append(None))
    assert list(times) == [*((name, clock) for name in own for clock in (HOST, EVENT)), ("a", HOST), ("b", HOST)]
    assert {len(samples) for samples in times.values()} == {len(ticks)} == {rounds}
    light = [float(frame.color.sum()) for frame in room_frames(SHAPE, PERIOD)]
    assert turns == [(name, light[n % PERIOD]) for n in range(rounds) for name in "ab"]


def test_a_time_covers_its_own_turn_only(queue: cl.CommandQueue, monkeypatch: pytest.MonkeyPatch) -> None:
    """Milliseconds from a clock that only the denoisers move; the device's own times are not of this clock."""
    now = [0.0]
    monkeypatch.setattr(race.time, "perf_counter", lambda: now[0])

    class Slow(Denoiser):
        def denoise(self, *args, **kwargs):
            now[0] += 1e-3
            return super().denoise(*args, **kwargs)

    class SlowRival(Rival):
        def load(self, frame: Frame) -> None:
            now[0] += 10.0

        def execute(self) -> None:
            now[0] += 5e-3

        def check(self) -> None:
            now[0] += 10.0

    times = race.race({"slow": Slow(SHAPE, queue=queue)}, {"a": SlowRival("a", [])}, 2, lambda: None)
    assert times["slow", HOST] == pytest.approx([1e-3, 1e-3])
    assert times["a", HOST] == pytest.approx([5e-3, 5e-3])


def test_times_become_results_of_the_benchmark() -> None:
    (result,) = race.results({("OIDN high", HOST): [0.5, 0.6]}, "0:0", (720, 1280))
    assert (result.name, result.device, result.clock) == ("race.oidn.high.1280x720", "0:0", HOST)
    assert result.facts["race"] == "OIDN high"
    assert result.median == 0.55
