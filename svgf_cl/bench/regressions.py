"""The gate of ``svgf-cl bench``: which benchmarks of the project became slower than an earlier run allows."""

from __future__ import annotations

from svgf_cl.bench.compare import Key
from svgf_cl.bench.results import Result, Run
from svgf_cl.bench.rig import EVENT
from svgf_cl.bench.tables import milliseconds
from svgf_cl.errors import SvgfError
from svgf_cl.filters import FILTERS
from svgf_cl.gate import Check


def checks(old: Run, new: Run, ratio: float) -> list[Check]:
    """Hold each benchmark that both runs have against `ratio`, new time over old.

    Benchmarks are matched by name and OpenCL implementation.

    Raises
    ------
    SvgfError
        If the runs have no such benchmark in common: nothing was checked then.
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
    """Find what a change of the project can make slower, each by the clock that says most.

    These are the filters' passes and frames. Ceilings belong to the machine. Start times are left out: a cold start has
    one sample and a warm one three, and they mostly tell what the driver's compiler and the disk do.

    Event time is taken where there is one. Host time adds launching and waiting, which the operating system disturbs.
    It counts where it is all there is: calls with numpy arrays, and what a frame costs the calling thread.
    """
    own = [result for result in run.results if belongs(result.name)]
    timed = {(result.name, result.device) for result in own if result.clock == EVENT}
    return {
        (result.name, run.platforms[result.device], result.clock): result
        for result in own
        if result.clock == EVENT or (result.name, result.device) not in timed
    }


def belongs(name: str) -> bool:
    """Whether a benchmark is a pass or frame of a filter."""
    filter_, row, *_ = [*name.split("."), ""]
    return filter_ in FILTERS and row != "start"


def complaint(old: Result, new: Result, ratio: float) -> str:
    """Say how much slower it became; nothing unless the slowdown lies beyond the spread of both runs.

    The new run's lower quartile has to be above `ratio` times the old run's upper one: three quarters of the new
    samples are then slower than three quarters of the old ones by more than `ratio`. The ratio of the medians, which is
    what is told, is then above `ratio` too.
    """
    if new.stats.q1 <= ratio * old.stats.q3:
        return ""
    times = f"{milliseconds(old.median)} ms before, {milliseconds(new.median)} ms now ({new.clock} time)"
    return f"{times}, {new.median / old.median:.2f} times as long"


def names(found: dict[Key, Result]) -> str:
    """A few of the benchmarks' names and where they ran, for an error."""
    shown = [f"{name} on {platform}" for name, platform, _ in found]
    return ", ".join(shown[:2]) + (f" and {len(shown) - 2} more" if len(shown) > 2 else "") or "none"
