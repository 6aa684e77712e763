"""The gate's answers are known for runs that are made up."""

from __future__ import annotations

from dataclasses import replace

import pytest

from svgf_cl import SvgfError
from svgf_cl.bench.regressions import checks
from svgf_cl.bench.results import Run
from svgf_cl.gate import Check
from tests.svgf_cl.bench.runs import device, result, run

OLD = run(result("frame", "event", 9.0, 10.0, 10.0, 10.0, 11.0))


def frame(*ms: float) -> Run:
    """A run of one frame with these samples."""
    return run(result("frame", "event", *ms))


def names(old: Run, new: Run, ratio: float = 1.1) -> list[str]:
    """What became too slow."""
    return [check.name for check in checks(old, new, ratio) if check.complaint]


@pytest.mark.parametrize(
    ("new", "ratio", "is_slower"),
    [
        ((12.0,) * 5, 1.1, True),
        ((12.0,) * 5, 1.15, True),  # above 11.8, the ratio times the upper quartile of 10.25
        ((12.0,) * 5, 1.18, False),  # the medians are 1.2 apart, but not beyond the old run's spread
        ((10.0, 10.0, 12.0, 14.0, 14.0), 1.1, False),  # nor the new run's
        ((10.0,) * 5, 1.1, False),
        ((5.0,) * 5, 1.1, False),
        ((10.0,) * 5, 0.9, True),  # a ratio below 1 asks for a gain
        ((5.0,) * 5, 0.9, False),
    ],
)
def test_slower_beyond_ratio_and_spread(new: tuple[float, ...], ratio: float, is_slower: bool) -> None:
    assert bool(names(OLD, frame(*new), ratio)) == is_slower


def test_exactly_the_ratio_passes() -> None:
    assert names(frame(8.0), frame(10.0), 1.25) == []
    assert names(frame(8.0), frame(10.0), 1.24) == ["svgf.frame.1280x720"]


def test_a_complaint_names_times_and_ratio() -> None:
    assert checks(OLD, frame(12.0, 12.0, 12.0), 1.1) == [
        Check("svgf.frame.1280x720", "Alpha", "10.00 ms before, 12.00 ms now (event time), 1.20 times as long")
    ]


def test_one_slow_pass_of_many() -> None:
    rows = ("temporal", "atrous 1", "atrous", "frame")
    old = run(*(result(row, "event", 5.0) for row in rows))
    new = run(*(result(row, "event", 6.0 if row == "atrous 1" else 5.0) for row in rows))
    assert len(checks(old, new, 1.1)) == 4
    assert names(old, new) == ["svgf.atrous.1.1280x720"]


def test_host_time_counts_only_where_it_is_all_there_is() -> None:
    both = [result("frame", "event", 10.0), result("frame", "host", 10.0), result("frame numpy", "host", 20.0)]
    slow = [result("frame", "event", 10.0), result("frame", "host", 30.0), result("frame numpy", "host", 60.0)]
    assert names(run(*both), run(*slow)) == ["svgf.frame.numpy.1280x720"]


def test_machine_and_start_and_other_programs_do_not_count() -> None:
    def times(ms: float) -> Run:
        others = [
            replace(result("", "event", ms), name="ceiling.copy.65536"),
            replace(result("", "host", ms, on="tracer: cornell"), name="tracer.frame.1280x720"),
            result("start cold", "host", ms),
            result("start warm", "host", ms, ms, ms),
        ]
        return run(result("frame", "event", 1.0), *others)

    assert [check.name for check in checks(times(1.0), times(9.0), 1.1)] == ["svgf.frame.1280x720"]
    assert names(times(1.0), times(9.0)) == []


def test_each_implementation_counts_by_itself() -> None:
    devices = (device("0:0"), device("1:0", platform="Beta"))
    old = run(result("frame", "event", 1.0), result("frame", "event", 1.0, on="1:0"), devices=devices)
    new = run(result("frame", "event", 1.0), result("frame", "event", 2.0, on="1:0"), devices=devices)
    assert [bool(check.complaint) for check in checks(old, new, 1.1)] == [False, True]
    assert [check.group for check in checks(old, new, 1.1)] == ["Alpha", "Beta"]


@pytest.mark.parametrize(
    ("new", "found"),
    [
        (run(result("temporal", "event", 1.0)), "svgf.temporal.1280x720 on Alpha in the new one"),
        (run(result("frame", "event", 1.0), devices=(device(platform="Beta"),)), "svgf.frame.1280x720 on Beta in"),
        (run(result("start cold", "host", 1.0)), "none in the new one"),
        (run(*(result(f"atrous {level}", "event", 1.0) for level in range(1, 6))), "on Alpha and 3 more in the new"),
    ],
)
def test_nothing_in_common_is_no_pass(new: Run, found: str) -> None:
    with pytest.raises(SvgfError, match="--fail-above: expected the runs to share a pass or a frame") as error:
        checks(OLD, new, 1.1)
    assert "svgf.frame.1280x720 on Alpha in the old run" in str(error.value)
    assert found in str(error.value)
