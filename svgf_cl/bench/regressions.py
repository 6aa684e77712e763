"""Checks for ``svgf-cl bench --fail-above``: which benchmarks became slower than in an earlier run."""

from __future__ import annotations

from svgf_cl.bench.compare import Key
from svgf_cl.bench.results import Result, Run
from svgf_cl.bench.rig import EVENT
from svgf_cl.bench.tables import milliseconds
from svgf_cl.errors import SvgfError
from svgf_cl.filters import FILTERS
from svgf_cl.gate import Check


def checks(old: Run, new: Run, ratio: float) -> list[Check]:
    """Check for each benchmark that both runs have that new time over old time is not above `ratio`.

    Benchmarks are matched by name and OpenCL implementation.

    Raises
    ------
    SvgfError
        If the runs have no such benchmark in common, so that there is nothing to check.
    """
    before, after = gated(old), gated(new)
    shared = [key for key in after if key in before]
    if not shared:
        raise SvgfError(
            f"--fail-above: expected the runs to share a pass or a frame on one implementation, "
            f"found {names(before)} in the old run and {names(after)} in the new one"
        )
    return [Check(key[0], key[1], complaint(before[key], after[key], ratio)) for key in shared]


def gated(run: Run) -> dict[Key, Result]:
    """Return the benchmarks that a change of the project can make slower, each by its most reliable clock.

    These are the filters' passes and frames. Ceilings depend on the machine only. Start times are left out, because a
    cold start has one sample and a warm start three, and both mostly depend on the driver's compiler and the disk.

    The clock is event time if there is one. Host time also contains launching and waiting, which the operating system
    disturbs. It is used where it is the only time: calls with numpy arrays, and the time until a call returns.
    """
    own = [result for result in run.results if belongs(result.name)]
    timed = {(result.name, result.device) for result in own if result.clock == EVENT}
    return {
        (result.name, run.platforms[result.device], result.clock): result
        for result in own
        if result.clock == EVENT or (result.name, result.device) not in timed
    }


def belongs(name: str) -> bool:
    """Whether a benchmark is a pass or a frame of a filter."""
    filter_, row, *_ = [*name.split("."), ""]
    return filter_ in FILTERS and row != "start"


def complaint(old: Result, new: Result, ratio: float) -> str:
    """Return how much slower a benchmark became; empty if the slowdown is within the spread of both runs.

    The new run's lower quartile must be above `ratio` times the old run's upper quartile. Then three quarters of the
    new samples are slower than three quarters of the old ones by more than `ratio`, and so is the ratio of the medians,
    which is reported.
    """
    if new.stats.q1 <= ratio * old.stats.q3:
        return ""
    times = f"{milliseconds(old.median)} ms before, {milliseconds(new.median)} ms now ({new.clock} time)"
    return f"{times}, {new.median / old.median:.2f} times as long"


def names(found: dict[Key, Result]) -> str:
    """Return a few of the benchmarks' names and their implementations, for an error."""
    shown = [f"{name} on {platform}" for name, platform, _ in found]
    return ", ".join(shown[:2]) + (f" and {len(shown) - 2} more" if len(shown) > 2 else "") or "none"
