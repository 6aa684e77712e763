"""The limits ("bars") that filter and tracer should keep, and whether a run keeps them."""

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
    """A limit for a measured figure.

    Parameters
    ----------
    what : str
    limit : float
    unit : str
        Written after the figures.
    measure : callable
        Computes the figure from a device's results; `LookupError` if results are missing.
    least : bool
        True: the figure has to be at least the limit; False: at most.
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
    """The result with these facts (or with this clock); `LookupError` if there is none."""
    for result in results:
        known = result.facts | {"clock": result.clock}
        if all(known.get(name) == value for name, value in facts.items()):
            return result
    raise LookupError(facts)


def times_faster(rival: str, settings: str) -> Callable[[Results], float]:
    """Median over the rounds of how many times as long the rival took as svgf_cl, for a whole call."""

    def measure(results: Results) -> float:
        slow, fast = (find(results, race=name, clock=HOST).seconds for name in (rival, f"svgf_cl {settings}"))
        return float(np.median(np.divide(slow, fast)))

    return measure


def roofline(row: str) -> Callable[[Results], float]:
    """The share of its roofline that a row reaches, in percent."""

    def measure(results: Results) -> float:
        share = find(results, row=row, clock=EVENT, **USUAL).roofline
        assert share is not None
        return 100 * share

    return measure


def second_signal(results: Results) -> float:
    """The time that a second signal adds to a frame, in percent."""
    one, two = (find(results, row="frame", variant=f"signals{count}", clock=EVENT).median for count in (1, 2))
    return 100 * (two / one - 1)


def nonlinearity(results: Results) -> float:
    """The largest difference of the time per pixel in larger frames from that at the usual size, in percent."""
    usual = find(results, row="frame", clock=EVENT, **USUAL)
    frames = [r for r in results if (r.facts.get("row"), r.facts.get("variant"), r.clock) == ("frame", "", EVENT)]
    larger = [per_pixel(r) for r in frames if r.facts["height"] > usual.facts["height"]]
    if not larger:
        raise LookupError("only one size")
    return 100 * max(abs(each / per_pixel(usual) - 1) for each in larger)


def per_pixel(result: Result) -> float:
    """Seconds per pixel."""
    return result.median / float(result.facts["width"] * result.facts["height"])


def memory(results: Results) -> float:
    """MB of device memory of a denoiser with one signal at 1920x1080."""
    return float(find(results, row="frame", width=1920, height=1080, variant="", clock=EVENT).facts["planes"]) / 1e6


def start(kind: str) -> Callable[[Results], float]:
    """Seconds until the first frame is done."""
    return lambda results: find(results, row=f"start {kind}").median


def enqueue(results: Results) -> float:
    """Milliseconds of the calling thread for a frame."""
    return 1e3 * find(results, row="enqueue", clock=HOST, **USUAL).median


def over_embree(results: Results) -> float:
    """Median over the rounds of how many times as long a frame takes as its rays take in raw Embree."""
    frame, rays = (find(results, row=f"tracer {what}", clock=HOST, **USUAL) for what in ("frame", "embree"))
    return float(np.median(np.divide(frame.seconds, rays.seconds)))


def tracer_memory(results: Results) -> float:
    """The peak memory of a new process, in GB."""
    return float(find(results, row="tracer start load", width=1920, height=1080).facts["peak"]) / 1e9


def over_svgf(results: Results) -> float:
    """Median over the rounds of how many times as long the default filter took as SVGF with 3x3 taps."""
    default, svgf = (find(results, race=f"svgf_cl {name}", clock=HOST).seconds for name in ("default", "SVGF"))
    return float(np.median(np.divide(default, svgf)))


def race_bar(kind: str, settings: str, rival: str, factor: float) -> Bar:
    """The bar for the speed of svgf_cl with these settings, compared with Open Image Denoise."""
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
    """The bar that Intel's runtime is as fast as PoCL, for these results of PoCL."""

    def measure(results: Results) -> float:
        intel, other = (find(each, row="frame", clock=EVENT, **USUAL).median for each in (results, pocl))
        return intel / other

    return Bar("a frame's time, Intel's runtime over PoCL", 1, "", measure)


def bar_table(results: Results, platforms: Mapping[str, str]) -> Table:
    """A row for each bar and device for which `results` has the figures; `platforms` has names by device selector."""
    found = [(name, [r for r in results if r.device == selector]) for selector, name in platforms.items()]
    held = [(bar, *each) for bar in BARS for each in found]
    by_name = dict(found)
    if INTEL.platform in by_name and POCL in by_name:
        held.append((against_pocl(by_name[POCL]), INTEL.platform, by_name[INTEL.platform]))
    rows = [row for each in held for row in judged(*each)]
    return Table("bars; at 1280x720 unless a size is named", ("bar", "implementation", "wanted", "measured", ""), rows)


def judged(bar: Bar, platform: str, results: Results) -> Iterator[tuple[str, ...]]:
    """The row of a bar, if the figures exist."""
    try:
        figure = bar.measure(results)
    except LookupError:
        return
    yield bar.what, platform, bar.wanted, f"{figure:.3g}{bar.unit}", "holds" if bar.holds(figure) else "missed"
