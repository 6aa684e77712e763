"""The tables say what was measured."""

from __future__ import annotations

import pytest

from benchmarks.bars import bar_table
from benchmarks.tracing.recording import KINDS, THREADS
from benchmarks.tracing.split import PARTS
from benchmarks.tracing.tables import tables
from svgf_cl.bench.compare import comparison
from svgf_cl.bench.results import Run
from svgf_cl.bench.tables import Table
from tests.benchmarks.tracing.made_up import tracer_results


@pytest.fixture
def shown() -> dict[str, Table]:
    """By what they are of."""
    return dict(zip(("frame", "rays", "split", "start", "memory"), tables(tracer_results()), strict=True))


def test_a_frame_over_raw_embree_in_the_same_round(shown: dict[str, Table]) -> None:
    frame, alone, *one = shown["frame"].rows
    assert "tracer: box, 1280x720" in shown["frame"].title
    assert frame[3] == frame[5] == "1.50 (1.50-1.50)"
    assert frame[6:] == ("0.500", "19.00", "4.44"), "1 / (0.5 * 0.45 s)"
    assert alone[3] == "1.00 (1.00-1.00)"
    assert [row[1] for row in one] == ["1"] * (THREADS > 1)
    assert all(row[3].startswith(f"{THREADS}.00 ") for row in one)


def test_every_kind_of_ray(shown: dict[str, Table]) -> None:
    assert [row[0] for row in shown["rays"].rows] == [*KINDS, "all"]
    rays, asked, one, every, faster = shown["rays"].rows[0][1:]
    assert (rays, asked) == ("1,000,000", "2,000,000")
    assert float(every) == pytest.approx(1.0 / (0.2 / 3), rel=1e-3)
    assert float(one) == pytest.approx(float(every) / THREADS, rel=1e-2)
    assert faster == f"{THREADS}.00"


def test_every_part_of_the_time(shown: dict[str, Table]) -> None:
    assert [row[0] for row in shown["split"].rows] == [*PARTS, "all"]
    assert shown["split"].rows[0][1:] == ("10.00", f"{100 / len(PARTS):.1f}")
    assert shown["split"].rows[-1][1] == "90.00"


def test_start_and_memory(shown: dict[str, Table]) -> None:
    assert [row[1] for row in shown["start"].rows] == ["0.50", "0.20", "20.00", "0.40"]
    assert [row[1] for row in shown["memory"].rows] == ["300", "50", "900"]


@pytest.mark.parametrize(("ms", "verdict"), [(360.0, "holds"), (361.0, "missed")])
def test_bars(ms: float, verdict: str) -> None:
    run = Run((), tracer_results(ms), (), {}, {}, "")
    over, memory = bar_table(run.results, run.platforms).rows
    assert over[1:3] == ("tracer: box", "at most 1.8 times")
    assert over[-1] == verdict
    assert memory[2:] == ("at most 3 GB", "0.9 GB", "holds")


def test_runs_are_compared_scene_by_scene() -> None:
    commit = {"version": "1", "id": "0", "dirty": False}
    old, new = (Run((), tracer_results(ms), (), {}, commit, "") for ms in (300.0, 150.0))
    rows = {(row[0], row[2]): row[-1] for row in comparison(old, new).rows}
    assert rows["tracer.frame.1280x720", "host"] == rows["tracer.frame.1280x720", "cpu"] == "2.00"
    assert rows["tracer.embree.1280x720", "host"] == "1.00"
