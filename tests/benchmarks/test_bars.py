"""A bar is held against what was measured, and only where it was."""

from __future__ import annotations

import pytest

from benchmarks.bars import BARS, INTEL, POCL, Bar, bar_table
from svgf_cl.bench.results import Result
from tests.svgf_cl.bench.runs import BOUND, result

ALONE = {"0:0": "Alpha"}


def rows(*results: Result, platforms: dict[str, str] = ALONE) -> dict[str, tuple[str, ...]]:
    """Of the table, by the bar's name."""
    return {row[0]: tuple(row[1:]) for row in bar_table(results, platforms).rows}


def raced(name: str, *ms: float) -> Result:
    return Result("race", "0:0", "host", tuple(1e-3 * value for value in ms), {"race": name})


@pytest.mark.parametrize(("figure", "least", "holds"), [(14.9, True, False), (15, True, True), (14.9, False, True)])
def test_a_limit(figure: float, least: bool, holds: bool) -> None:
    assert Bar("", 15, "", lambda _: 0.0, least=least).holds(figure) == holds


def test_what_was_not_measured_is_not_judged() -> None:
    assert rows() == {}
    assert rows(result("temporal", "event", 1.0, on="0:1", **BOUND)) == {}, "another device's"


def test_a_race_is_judged_by_the_median_ratio_of_a_round() -> None:
    found = rows(raced("svgf_cl 5x5", 10, 30, 10), raced("OIDN high", 140, 480, 160))
    assert found == {"bar: 5x5 faster than OIDN high": ("Alpha", "at least 15 times", "16 times", "holds")}
    ours = raced("svgf_cl 5x5", 10), raced("svgf_cl default", 5), raced("svgf_cl SVGF", 4)
    more = rows(*ours, raced("OIDN fast", 79))
    assert [row[-1] for row in more.values()] == ["missed", "holds", "holds"]


def test_stages_are_judged_by_their_own_roofline() -> None:
    levels, temporal = (result(row, "event", 10.0, 20.0, **BOUND) for row in ("atrous", "temporal"))
    assert rows(levels, temporal) == {
        "a-trous levels, of their roofline": ("Alpha", "at least 50 %", "40 %", "missed"),
        "temporal, of its roofline": ("Alpha", "at least 30 %", "40 %", "holds"),
    }


def test_how_time_grows() -> None:
    signals = (result("frame", "event", 10.0 * n, variant=f"signals{n}", signals=n) for n in (1, 2))
    sizes = (result("frame", "event", ms, width=w, height=h) for ms, w, h in ((1, 320, 180), (10, 1280, 720)))
    large = result("frame", "event", 72.0, width=3840, height=2160)
    found = rows(*signals, *sizes, large)
    assert found["a second signal's time beside the first's"][1:] == ("at most 70 %", "100 %", "missed")
    assert found["time per pixel off that of 1280x720, in larger frames"][1:] == ("at most 15 %", "20 %", "missed")


def test_memory_starts_and_host() -> None:
    found = rows(
        result("frame", "event", 1.0, width=1920, height=1080, planes=149e6),
        result("start cold", "host", 9e3),
        result("start warm", "host", 0.9e3, 1.1e3, 0.8e3),
        result("enqueue", "host", 0.2),
    )
    assert [row[2:] for row in found.values()] == [
        ("149 MB", "holds"),
        ("0.2 ms", "holds"),
        ("9 s", "holds"),
        ("0.9 s", "holds"),
    ]


def test_runtimes_are_held_against_each_other() -> None:
    frames = result("frame", "event", 10.0, on="0:0"), result("frame", "event", 11.0, on="1:0")
    found = rows(*frames, platforms={"0:0": POCL, "1:0": INTEL.platform})
    assert found == {"a frame's time, Intel's runtime over PoCL": (INTEL.platform, "at most 1", "1.1", "missed")}
    assert rows(*frames, platforms={"0:0": POCL}) == {}


def test_names_are_distinct() -> None:
    assert len({bar.what for bar in BARS}) == len(BARS)
