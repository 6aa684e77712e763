"""The search, with times that are made up: it finds what is faster, keeps the default, rejects what is wrong."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from functools import partial
from types import SimpleNamespace
from typing import Any

import numpy as np
import pyopencl as cl
import pytest

from svgf_cl import Denoiser, Eaw, Frame, Tuning
from svgf_cl.bench import tuner
from svgf_cl.bench.tuner import FINAL_ROUNDS, GPU_CHOICES, Trial, Tuner
from svgf_cl.device.tuning import EXPONENTIALS, GPU_TUNING

SHAPE = (9, 20)
DEFAULT = Tuning(vector_width=16, work_group=(64, 1))
ODD = Tuning(vector_width=4, work_group=(8, 2))


class FakeDenoiser:
    """Takes the time that `cost` says, with noise of 10 %, and gives a picture of ones, or of `wrong` tunings zeros."""

    cost: Any
    wrong: tuple[Tuning, ...] = ()
    refused: tuple[Tuning, ...] = ()
    noise = 0.1

    def __init__(self, shape: Any, *, queue: Any, tuning: Tuning) -> None:
        if tuning in self.refused:
            raise cl.LogicError("no such work-group")
        self.tuning = tuning

    def denoise(self, frame: Frame, *, out: np.ndarray) -> None:
        out[:] = 0 if self.tuning in self.wrong else 1

    def profile(self) -> dict[str, float]:
        return {"all": type(self).cost(self.tuning) * (1 + self.noise * self.rng.random())}

    rng = np.random.default_rng(0)


@pytest.fixture
def fake(monkeypatch: pytest.MonkeyPatch) -> type[FakeDenoiser]:
    """A device on which every tuning takes 10 ms."""

    class Fake(FakeDenoiser):
        rng = np.random.default_rng(0)

        @staticmethod
        def cost(tuning: Tuning) -> float:
            return 10.0

    monkeypatch.setattr(tuner, "Denoiser", Fake)
    monkeypatch.setattr(tuner, "default_tuning", lambda device: DEFAULT)
    return Fake


def by_parts(tuning: Tuning) -> float:
    """Vectors of 8 in tall groups, exp2, rows 256 apart, are the fastest, 41 % of the default's time."""
    good = (
        tuning.vector_width == 8,
        tuning.exponential == "exp2",
        tuning.work_group[1] == 4,
        tuning.row_alignment == 256,
    )
    return 10 * 0.8 ** sum(good)


def test_finds_the_best_of_every_knob(fake: type[FakeDenoiser], queue: cl.CommandQueue) -> None:
    fake.cost = staticmethod(by_parts)
    final = Tuner(SHAPE, queue).search()
    assert final.is_faster
    assert final.tuning.vector_width == 8
    assert final.tuning.exponential == "exp2"
    assert final.tuning.work_group[1] == 4
    assert final.tuning.row_alignment == 256
    assert final.ratio == pytest.approx(0.8**4, rel=0.1)


def test_noise_is_no_reason_to_leave_the_default(fake: type[FakeDenoiser], queue: cl.CommandQueue) -> None:
    assert not Tuner(SHAPE, queue).search().is_faster


def test_what_is_fast_but_wrong_or_refused_is_out(fake: type[FakeDenoiser], queue: cl.CommandQueue) -> None:
    wrong = Tuning(vector_width=4, work_group=(64, 1))
    refused = Tuning(vector_width=8, work_group=(64, 1))
    fake.wrong, fake.refused = (wrong,), (refused,)
    fake.cost = staticmethod(lambda tuning: 1.0 if tuning.vector_width < 16 else 10.0)
    search = Tuner(SHAPE, queue)
    final = search.search()
    faults = {trial.tuning: trial.fault for trial in search.trials}
    assert final.tuning.vector_width == 1
    assert "100.00% of its pixels differ" in faults[wrong]
    assert "no such work-group" in faults[refused]


@pytest.mark.parametrize("group", GPU_CHOICES["work_group"])
def test_groups_of_a_gpu_are_whole_warps_that_any_can_run(group: tuple[int, int]) -> None:
    assert math.prod(group) % 64 == 0
    assert math.prod(group) <= 256


def test_on_a_gpu_its_own_choices_are_tried(fake: type[FakeDenoiser], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tuner, "default_tuning", lambda device: GPU_TUNING)
    monkeypatch.setattr(Tuning, "check", lambda self, device: None)
    search = Tuner(SHAPE, SimpleNamespace(device=SimpleNamespace(type=cl.device_type.GPU)))
    search.search()
    tried = [trial.tuning for trial in search.trials]
    assert {tuning.vector_width for tuning in tried} == {1, 4}
    assert {tuning.work_group for tuning in tried} == set(GPU_CHOICES["work_group"])
    assert {tuning.exponential for tuning in tried} == set(EXPONENTIALS)


def test_copies_are_not_raced_where_memory_is_shared(
    fake: type[FakeDenoiser], queue: cl.CommandQueue, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(tuner, "shares_memory", lambda device: True)
    assert Tuner(SHAPE, queue).race_copies(DEFAULT) is None


@pytest.mark.parametrize(("share", "faster"), [(0.8, True), (1.0, False)])
def test_of_copies_the_whole_call_counts(
    share: float, faster: bool, fake: type[FakeDenoiser], queue: cl.CommandQueue, monkeypatch: pytest.MonkeyPatch
) -> None:
    now = [0.0]

    def denoise(self: FakeDenoiser, frame: Frame, *, out: np.ndarray) -> None:
        out[:] = 1
        now[0] += (share if self.tuning.pinned_copies else 1.0) * 0.005

    monkeypatch.setattr(tuner, "shares_memory", lambda device: False)
    monkeypatch.setattr(fake, "denoise", denoise)
    monkeypatch.setattr(tuner.time, "perf_counter", lambda: now[0])
    trial = Tuner(SHAPE, queue).race_copies(ODD)
    assert trial.tuning == replace(ODD, pinned_copies=True)
    assert trial.time == pytest.approx(5 * share)
    assert trial.ratio == pytest.approx(share)
    assert trial.is_faster == faster


def test_what_is_hopeless_is_not_timed(fake: type[FakeDenoiser], queue: cl.CommandQueue) -> None:
    fake.cost = staticmethod(lambda tuning: 100.0 if tuning.vector_width == 1 else 10.0)
    search = Tuner(SHAPE, queue)
    search.search()
    assert [trial.times for trial in search.trials if trial.tuning.vector_width == 1] == [[]]


def test_when_time_is_up_the_rest_is_counted(fake: type[FakeDenoiser], queue: cl.CommandQueue) -> None:
    search = Tuner(SHAPE, queue, seconds=0.0)
    steps = []
    assert not search.search(lambda: steps.append(1)).ratios
    assert len(steps) == search.steps
    assert len(search.trials) == 1
    assert search.untried > 10
    assert search.doubts == [f"no time was left for {search.untried} candidates"]


def test_a_steady_machine_leaves_no_doubts(fake: type[FakeDenoiser], queue: cl.CommandQueue) -> None:
    fake.cost = staticmethod(by_parts)
    search = Tuner(SHAPE, queue)
    search.search()
    assert search.doubts == []
    assert search.reference.tuning == DEFAULT
    assert len(search.reference.times) == FINAL_ROUNDS[1], "those of the final alone"


@pytest.mark.parametrize("cost", [by_parts, lambda tuning: 10.0], ids=["some are faster", "none is faster"])
def test_a_wavering_default_is_a_doubt(cost: Any, fake: type[FakeDenoiser], queue: cl.CommandQueue) -> None:
    fake.cost, fake.noise = staticmethod(cost), 1.0
    search = Tuner(SHAPE, queue)
    search.search()
    (doubt,) = search.doubts
    assert re.fullmatch(r"the default's own time varies by \d\d%, more than 10%", doubt)


@pytest.mark.parametrize(
    ("times", "wavering"),
    [([], 0.0), ([7.0], 0.0), ([8.0, 9.0, 10.0, 11.0, 12.0], 0.2), ([10.0] * 9 + [99.0], 0.0)],
)
def test_wavering_is_the_interquartile_range_over_the_median(times: list[float], wavering: float) -> None:
    assert Trial(DEFAULT, times=times).wavering == pytest.approx(wavering)


@pytest.mark.parametrize(
    ("ratios", "faster"),
    [
        ([0.9] * 10, True),
        ([0.9] * 8 + [1.5] * 2, True),
        ([0.9] * 7 + [1.1] * 3, False),
        ([0.99] * 10, False),
        ([], False),
    ],
)
def test_a_verdict_wants_a_gain_beyond_noise(ratios: list[float], faster: bool) -> None:
    assert Trial(DEFAULT, ratios=ratios).is_faster == faster


def test_on_the_device_no_tuning_changes_the_picture(queue: cl.CommandQueue, monkeypatch: pytest.MonkeyPatch) -> None:
    choices = {
        "vector_width": (4, 8),
        "exponential": EXPONENTIALS,
        "row_alignment": (16, 256),
        "work_group": ((8, 2),),
    }
    monkeypatch.setattr(tuner, "CHOICES", choices)
    monkeypatch.setattr(tuner, "Denoiser", partial(Denoiser, settings=Eaw(iterations=1)))  # the quickest to compile
    search = Tuner(SHAPE, queue, seconds=1e6)  # however long a busy machine takes to compile
    search.search()
    assert len(search.trials) >= 5
    assert not any(trial.fault for trial in search.trials)
