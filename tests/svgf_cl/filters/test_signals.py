"""What a frame supplies decides which signals are filtered."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from svgf_cl import Settings, SvgfError
from svgf_cl.filters import signals
from svgf_cl.filters.signals import COLOR, DIRECT, INDIRECT, SPLITS, Inputs, Signal
from svgf_cl.frame import CHANNELS
from tests.frames import FULL, PLAIN, SPLIT, bumpy, only

ALL = {"motion": 3, "albedo": True, "emission": True, "id": True}


@pytest.mark.parametrize(
    ("fields", "motion", "expected"),
    [
        (PLAIN, 2, Inputs(signals=(COLOR,), motion=2)),
        (FULL, 3, Inputs(signals=(COLOR,), **ALL)),
        (SPLIT, 3, Inputs(signals=(DIRECT, INDIRECT), **ALL)),
        ((*SPLIT, "color"), 3, Inputs(signals=(DIRECT, INDIRECT), **ALL)),
    ],
)
def test_inputs_are_the_frames_fields(fields: tuple[str, ...], motion: int, expected: Inputs) -> None:
    inputs = Inputs.of(only(bumpy(np.random.default_rng(0)), fields, motion))
    assert inputs == expected
    assert set(inputs.fields) == {"normal", "depth", "motion", *fields} - ({"color"} if "direct" in fields else set())


def test_every_is_the_most_that_frames_can_supply() -> None:
    assert Inputs.every() == Inputs(signals=(DIRECT, INDIRECT), **ALL)


def test_signals_are_told_by_name_and_come_from_fields_of_a_frame() -> None:
    for split in SPLITS:
        assert len({signal.name for signal in split}) == len(split)
        assert all(CHANNELS[signal.field] == (3,) for signal in split)


@pytest.mark.parametrize(("split", "holder"), [((COLOR,), 0), ((DIRECT, INDIRECT), -1)])
def test_emission_is_taken_out_of_what_holds_it(split: tuple[Signal, ...], holder: int) -> None:
    assert Inputs(signals=split, emission=True).emission_signal == holder
    assert Inputs(signals=split).emission_signal == -1


@pytest.mark.parametrize("wrong", [{"signals": ()}, {"signals": (DIRECT,)}, {"signals": ("color",)}, {"motion": 7}])
def test_inputs_that_no_frame_has_are_refused(wrong: dict) -> None:
    (name,) = wrong
    with pytest.raises(SvgfError, match=rf"Inputs\.{name}: expected .*, got"):
        Inputs(**wrong)


def test_signals_that_kernels_cannot_tell_apart_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    plain, bare = replace(INDIRECT, divided_by=None), replace(INDIRECT, carries=("mean",))
    monkeypatch.setattr(signals, "SPLITS", ((DIRECT, plain), (DIRECT, bare)))
    with pytest.raises(ValueError, match="all divided by albedo or none"):
        _ = Inputs(signals=(DIRECT, plain), albedo=True).divides_by_albedo
    with pytest.raises(ValueError, match="signals that carry the same"):
        Settings().moments(Inputs(signals=(DIRECT, bare)))


def test_kernels_know_signals_by_number() -> None:
    defines = Inputs(signals=(DIRECT, INDIRECT)).defines
    assert (defines["SIGNAL_DIRECT"], defines["SIGNAL_INDIRECT"], defines["SIGNALS"]) == (0, 1, 2)
