"""The bars that filter and tracer are held to, and what a run says of each."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from svgf_cl.bench.cases import USUAL_SHAPE
from svgf_cl.bench.results import Result
from svgf_cl.bench.rig import EVENT, HOST
from svgf_cl.bench.tables import Table
from svgf_cl.device.devices import POCL
from svgf_cl.device.drivers import INTEL

Results = Sequence[Result]

USUAL = {"height": USUAL_SHAPE[0], "width": USUAL_SHAPE[1], "variant": ""}


@dataclass(frozen=True)
class Bar:
    """A limit to what is measured.

    Parameters
    ----------
    what : str
    limit : float
    unit : str
        Behind the figures.
    measure : callable
        The figure, from a device's results; `LookupError` where they lack what it takes.
    least : bool
        The figure has to be at least the limit; else at most.
    """

    what: str
    limit: float
    unit: str
    measure: Callable[[Results], float]
    least: bool = False

    @property
    def wanted(self) -> str:
        """The limit in words."""
        return f"at {'least' if self.least else 'most'} {self.limit:g}{self.unit}"

    def holds(self, figure: float) -> bool:
        """Whether a figure is within the limit."""
        return figure >= self.limit if self.least else figure <= self.limit


def find(results: Results, **facts: Any) -> Result:
    """The result with these facts (or of this clock); `LookupError` where there is none."""
    for result in results:
        known = result.facts | {"clock": result.clock}
        if all(known.get(name) == value for name, value in facts.items()):
            return result
    raise LookupError(facts)


def times_faster(rival: str, settings: str) -> Callable[[Results], float]:
    """Median over the rounds of a race: how many times as long the rival took as a whole call."""

    def measure(results: Results) -> float:
        slow, fast = (find(results, race=name, clock=HOST).seconds for name in (rival, f"svgf_cl {settings}"))
        return float(np.median(np.divide(slow, fast)))

    return measure


def roofline(row: str) -> Callable[[Results], float]:
    """Percent of a row's roofline."""

    def measure(results: Results) -> float:
        share = find(results, row=row, clock=EVENT, **USUAL).roofline
        assert share is not None
        return 100 * share

    return measure


def second_signal(results: Results) -> float:
    """Percent that a second signal adds to a frame's time."""
    one, two = (find(results, row="frame", variant=f"signals{count}", clock=EVENT).median for count in (1, 2))
    return 100 * (two / one - 1)


def nonlinearity(results: Results) -> float:
    """Percent by which the time per pixel differs at most from that at the usual size, in larger frames."""
    usual = find(results, row="frame", clock=EVENT, **USUAL)
    frames = [r for r in results if (r.facts.get("row"), r.facts.get("variant"), r.clock) == ("frame", "", EVENT)]
    larger = [per_pixel(r) for r in frames if r.facts["height"] > usual.facts["height"]]
    if not larger:
        raise LookupError("only one size")
    return 100 * max(abs(each / per_pixel(usual) - 1) for each in larger)


def per_pixel(result: Result) -> float:
    """Seconds."""
    return result.median / float(result.facts["width"] * result.facts["height"])


def memory(results: Results) -> float:
    """MB held by the denoiser of one signal at 1920x1080."""
    return float(find(results, row="frame", width=1920, height=1080, variant="", clock=EVENT).facts["planes"]) / 1e6


def start(kind: str) -> Callable[[Results], float]:
    """Seconds to the first frame."""
    return lambda results: find(results, row=f"start {kind}").median


def enqueue(results: Results) -> float:
    """Milliseconds that a frame costs the calling thread."""
    return 1e3 * find(results, row="enqueue", clock=HOST, **USUAL).median


def over_embree(results: Results) -> float:
    """Median over the rounds: how many times as long the tracer took for a frame as raw Embree for the same rays."""
    frame, rays = (find(results, row=f"tracer {what}", clock=HOST, **USUAL) for what in ("frame", "embree"))
    return float(np.median(np.divide(frame.seconds, rays.seconds)))


def tracer_memory(results: Results) -> float:
    """GB that a new process held at most."""
    return float(find(results, row="tracer start load", width=1920, height=1080).facts["peak"]) / 1e9


def over_svgf(results: Results) -> float:
    """Median over the rounds of a race: how many times as long the default filter took as SVGF with 3x3 taps."""
    default, svgf = (find(results, race=f"svgf_cl {name}", clock=HOST).seconds for name in ("default", "SVGF"))
    return float(np.median(np.divide(default, svgf)))


def race_bar(kind: str, settings: str, rival: str, factor: float) -> Bar:
    """How many times as fast as Open Image Denoise svgf_cl with these settings has to be."""
    measure = times_faster(f"OIDN {rival}", settings)
    return Bar(f"{kind}: {settings} faster than OIDN {rival}", factor, " times", measure, least=True)


BARS = (
    race_bar("bar", "5x5", "high", 15),
    race_bar("bar", "5x5", "fast", 8),
    race_bar("bar", "default", "high", 20),
    race_bar("aim", "default", "fast", 15),
    Bar("aim: time of the default over that of SVGF", 1.3, " times", over_svgf),
    Bar("a-trous levels, of their roofline", 50, " %", roofline("atrous"), least=True),
    Bar("variance, of its roofline", 50, " %", roofline("variance"), least=True),
    Bar("temporal, of its roofline", 30, " %", roofline("temporal"), least=True),
    Bar("a second signal's time beside the first's", 70, " %", second_signal),
    Bar("time per pixel off that of 1280x720, in larger frames", 15, " %", nonlinearity),
    Bar("device memory at 1920x1080", 150, " MB", memory),
    Bar("host's time to enqueue a frame", 0.3, " ms", enqueue),
    Bar("start to first frame, cold caches", 10, " s", start("cold")),
    Bar("start to first frame, warm caches", 1, " s", start("warm")),
    Bar("the tracer's frame over raw Embree's time for its rays", 1.8, " times", over_embree),
    Bar("the tracer's memory with a frame of 1920x1080", 3, " GB", tracer_memory),
)


def against_pocl(pocl: Results) -> Bar:
    """Intel's runtime has to be as fast as PoCL, whose results are given."""

    def measure(results: Results) -> float:
        intel, other = (find(each, row="frame", clock=EVENT, **USUAL).median for each in (results, pocl))
        return intel / other

    return Bar("a frame's time, Intel's runtime over PoCL", 1, "", measure)


def bar_table(results: Results, platforms: Mapping[str, str]) -> Table:
    """A row for each bar and device of which `results` hold what it takes; `platforms` by the device's selector."""
    found = [(name, [r for r in results if r.device == selector]) for selector, name in platforms.items()]
    held = [(bar, *each) for bar in BARS for each in found]
    by_name = dict(found)
    if INTEL.platform in by_name and POCL in by_name:
        held.append((against_pocl(by_name[POCL]), INTEL.platform, by_name[INTEL.platform]))
    rows = [row for each in held for row in judged(*each)]
    return Table("bars; at 1280x720 unless a size is named", ("bar", "implementation", "wanted", "measured", ""), rows)


def judged(bar: Bar, platform: str, results: Results) -> Iterator[tuple[str, ...]]:
    """A bar's row, if it can be judged."""
    try:
        figure = bar.measure(results)
    except LookupError:
        return
    yield bar.what, platform, bar.wanted, f"{figure:.3g}{bar.unit}", "holds" if bar.holds(figure) else "missed"
