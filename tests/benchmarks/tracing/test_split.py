"""Each moment of a frame is counted once, and the loop's parts are taken out of the loop."""

from __future__ import annotations

import itertools

import pytest

from benchmarks.tracing import split as module
from benchmarks.tracing.recording import Recording
from benchmarks.tracing.split import (
    EMBREE,
    ENDS,
    G_BUFFER,
    LIGHTS,
    MASKS,
    NUMBERS,
    PARTS,
    REST,
    SHADING,
    TEXTURES,
    Tally,
    loop_shares,
    split,
    stage_times,
)
from svgf_cl_tracer import Shot


def test_time_within_another_watched_function_is_counted_there(monkeypatch: pytest.MonkeyPatch) -> None:
    ticks = itertools.count()
    monkeypatch.setattr("time.thread_time", lambda: float(next(ticks)))
    tally = Tally()
    inner, outer = tally.timed("inner"), tally.timed("outer")

    def work() -> str:
        inner(lambda: None)
        inner(lambda: None)
        return "done"

    assert outer(work) == "done"
    inner(lambda: None)
    assert tally.seconds == {"inner": 3.0, "outer": 3.0}  # from tick 0 to 5, less twice one tick


def test_stages_of_a_frame(shot: Shot) -> None:
    found = stage_times(shot, 3)
    assert found.keys() == {EMBREE, MASKS, SHADING, ENDS, REST}
    assert all(found[stage] > 0.0 for stage in (EMBREE, SHADING))


def test_shares_of_the_loop(recording: Recording) -> None:
    found = loop_shares(recording)
    assert found.keys() == {LIGHTS, NUMBERS, TEXTURES, G_BUFFER}
    assert found[NUMBERS] > 0.0


def test_shading_is_what_is_left_of_the_loop(shot: Shot, recording: Recording, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(
        module, "stage_times", lambda *_: {EMBREE: 50.0, MASKS: 1.0, SHADING: 40.0, ENDS: 5.0, REST: 4.0}
    )
    monkeypatch.setattr(module, "loop_shares", lambda _: {LIGHTS: 0.25, NUMBERS: 0.05, TEXTURES: 0.1, G_BUFFER: 0.1})
    found = split(shot, 3, recording)
    assert tuple(found) == PARTS
    assert found[SHADING] == pytest.approx(20.0)
    assert found[LIGHTS] == pytest.approx(10.0)
    assert sum(found.values()) == pytest.approx(100.0)
