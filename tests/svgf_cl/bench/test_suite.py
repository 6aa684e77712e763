"""The run times what was asked for, and says what it could not."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import pyopencl as cl
import pytest

from svgf_cl import Settings, SvgfError
from svgf_cl.bench import ceilings, station
from svgf_cl.bench.suite import TURNS, Suite, interleaved, timed_devices
from svgf_cl.device import devices

SMALL = (9, 16)


@pytest.fixture(autouse=True)
def one_device(queue: cl.CommandQueue, monkeypatch: pytest.MonkeyPatch) -> None:
    """Time the device under test alone, and quickly."""
    monkeypatch.setattr("svgf_cl.bench.suite.timed_devices", lambda: [devices.choose(devices.list_devices())])
    monkeypatch.setattr(ceilings, "WORKING_SETS", (2**22,))
    monkeypatch.setattr(ceilings, "COPIED", 1)
    monkeypatch.setattr(station, "error_to_oracle", lambda *_, **__: (2e-7, 1e-7))


class Steps:
    """Counts what a progress bar would show."""

    def __init__(self) -> None:
        self.expected = self.done = 0

    @contextmanager
    def bar(self, _: str, total: int) -> Iterator[Callable[[], None]]:
        self.expected += total
        yield self.advance

    def advance(self) -> None:
        self.done += 1


def test_a_filter_chooses_by_name() -> None:
    steps = Steps()
    run = Suite(re.compile(r"svgf\.(atrous\.2|enqueue)\.16x9"), Settings(), [SMALL], seconds=0.0).run(steps.bar)
    timed = [result for result in run.results if not result.name.startswith("ceiling.")]
    names = [(result.name, result.clock) for result in timed]
    assert sorted(names) == [("svgf.atrous.2.16x9", c) for c in ("event", "host")] + [("svgf.enqueue.16x9", "host")]
    assert all(len(result.seconds) == TURNS for result in timed)
    assert {result.name for result in run.results} >= {"ceiling.multiply"}
    assert steps.done == steps.expected > 0
    assert (run.devices[0].largest, run.devices[0].rms) == (2e-7, 1e-7)


def test_a_frame_knows_its_cost_and_memory() -> None:
    run = Suite(re.compile(r"frame\.16x9|atrous\.16x9"), Settings(), [SMALL], seconds=0.0).run(Steps().bar)
    (frame,) = run.of(run.devices[0], row="frame", clock="event")
    (levels,) = run.of(run.devices[0], row="atrous", clock="event")
    assert frame.facts["planes"] > 0
    assert 0 < levels.facts["bound"] < frame.facts["bound"]
    assert 0 < levels.facts["flops"] < frame.facts["flops"]


def test_without_ceilings_there_is_no_bound() -> None:
    run = Suite(re.compile(r"frame\.16x9"), Settings(), [SMALL], seconds=0.0, ceilings=False).run(Steps().bar)
    assert {result.name for result in run.results} == {"svgf.frame.16x9"}
    assert all(result.roofline is None for result in run.results)
    assert run.devices[0].ceilings is None


def test_names_are_those_that_a_run_would_time(monkeypatch: pytest.MonkeyPatch) -> None:
    suite = Suite(re.compile(r"svgf\.(atrous\.2|enqueue)\.16x9"), Settings(), [SMALL], seconds=0.0)
    assert suite.names() == ["svgf.atrous.2.16x9", "svgf.enqueue.16x9"]
    run = suite.run(Steps().bar)
    assert {result.name for result in run.results if not result.name.startswith("ceiling.")} == set(suite.names())
    monkeypatch.setattr("svgf_cl.bench.suite.timed_devices", lambda: 2 * [devices.choose(devices.list_devices())])
    assert len(suite.names()) == 2, "each once, on however many devices"


def test_names_follow_sizes_and_settings() -> None:
    names = Suite(re.compile("svgf"), Settings(iterations=2), [SMALL, (1, 2)]).names()
    assert {"svgf.frame.16x9", "svgf.frame.2x1", "svgf.atrous.2.2x1", "svgf.start.cold.1280x720"} <= set(names)
    assert "svgf.frame.signals2.1280x720" in names
    assert "svgf.atrous.3.16x9" not in names


def test_no_name_matches() -> None:
    suite = Suite(re.compile("nothing"), Settings(), [SMALL])
    for call in (suite.names, lambda: suite.run(Steps().bar)):
        with pytest.raises(SvgfError, match=r"--only: expected part of a name such as .*, got nothing"):
            call()


def test_what_has_no_room_is_left_out(monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object, **__: object) -> None:
        raise SvgfError("no room for a buffer of 8 MiB")

    monkeypatch.setattr(station, "Rig", full)
    run = Suite(re.compile("frame.16x9"), Settings(), [SMALL], seconds=0.0).run(Steps().bar)
    (line,) = run.left_out
    assert line.startswith("svgf.frame.16x9 on ")
    assert line.endswith("no room for a buffer of 8 MiB")


def test_a_named_device_is_the_only_one(monkeypatch: pytest.MonkeyPatch) -> None:
    default = devices.choose(devices.list_devices())
    monkeypatch.setenv(devices.VARIABLE, default.selector)
    assert timed_devices() == [default]


def test_devices_take_turns() -> None:
    assert interleaved([[1, 2, 3], [4], [5, 6]]) == [1, 4, 5, 2, 6, 3]
