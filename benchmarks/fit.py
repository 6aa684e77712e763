"""Fits each filter's own settings to training sequences, and measures the gain on other sequences.

A fair comparison gives every filter its best settings. They are fitted to random rooms (`benchmarks.training.rooms`)
and measured on scenes that were not used for the fit. The fit minimises the mean over the sequences of

``log2(root mean square error) + log2(temporal error)``

Both are of the picture as shown, without the truth's noise (`svgf_cl.compare.halves`). One bit is half the error, or
half the flicker. The search is Nelder and Mead's (SciPy), over the binary logarithms of the settings.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Annotated

import numpy as np
import typer
from numpy.typing import NDArray

from benchmarks.command import run
from benchmarks.presentation import markdown
from benchmarks.provenance import provenance
from benchmarks.training.rooms import room
from svgf_cl import Denoiser
from svgf_cl.bench.tables import Table
from svgf_cl.cli.console import progress_bar, show
from svgf_cl.cli.options import parse_size
from svgf_cl.compare.footage import Choice
from svgf_cl.compare.halves import Pair, squared_change, squared_error
from svgf_cl.device import devices
from svgf_cl.errors import SvgfError
from svgf_cl.filters import FILTERS
from svgf_cl.filters.filter import Filter
from svgf_cl.frame import Frame
from svgf_cl.io.display import Linear, display
from svgf_cl.settings import Range, domains
from svgf_cl_tracer import Shot
from svgf_cl_tracer.cli.footage import Traced, open_footage

# The filters' own settings for averaging. Accumulation over time is the same for all filters.
FITTED: Mapping[str, tuple[str, ...]] = {
    "svgf": ("sigma_luminance", "sigma_depth", "sigma_normal"),
    "eaw": ("sigma_color", "sigma_depth", "sigma_normal"),
    "sbf": ("gamma_depth", "gamma_normal"),
    "kalman": ("sigma_luminance", "change_threshold", "sigma_depth", "sigma_normal"),
}
HELD_OUT = ("cornell", "glossy", "swing", "switch", "fireflies", "static")
JUDGED = 6  # last frames
FRAMES = 14
FIRST_STEP = 0.7  # octaves
LEAST = 1e-12  # the least square error that counts: smaller ones are not better

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class RoomFootage(Traced):
    """A random room; its name is its number."""

    @property
    def name(self) -> str:
        """The room's number."""
        return f"room {self.scene}"

    @cached_property
    def shot(self) -> Shot:
        """The room with its own camera path."""
        return Shot(room(int(self.scene)), self.shape, len(self.numbers))


@dataclass(frozen=True, eq=False)
class Clip:
    """A sequence in memory.

    Parameters
    ----------
    name : str
    frames : sequence of Frame
    truths : mapping of int to two of (H, W, 3)
        Halves of the truth of the measured frames as shown, by number from 0.
    """

    name: str
    frames: Sequence[Frame]
    truths: Mapping[int, Pair]

    @classmethod
    def of(cls, footage: Traced, advance: Callable[[], None]) -> Clip:
        """Render it."""
        truths = {number: (display(a), display(b)) for number, (a, b) in footage.truths(advance).items()}
        return cls(footage.name, list(footage.frames()), truths)

    def badness(self, settings: Filter) -> float:
        """log2 of the error plus log2 of the temporal error of a filter."""
        errors, changes = [], []
        before: tuple[Linear, Pair] | None = None
        with Denoiser(self.frames[0].shape, settings=settings) as denoiser:
            for number, frame in enumerate(self.frames):
                picture = denoiser.denoise(frame)
                if number in self.truths:
                    shown, truth = display(picture), self.truths[number]
                    errors.append(squared_error(shown, truth).value)
                    if before:
                        changes.append(squared_change(before[0], shown, before[1], truth).value)
                    before = shown, truth
        return sum(0.5 * float(np.log2(max(float(np.mean(squares)), LEAST))) for squares in (errors, changes))


def fit(
    filters: Annotated[
        list[str], typer.Argument(metavar="[FILTER]...", help=f"Out of {', '.join(FITTED)}; all by default.")
    ] = [],  # noqa: B006  # never changed; typer wants the default spelled here
    held_out: Annotated[
        list[str],
        typer.Option(
            metavar="SCENE", help=f"A held-out scene to measure, may be repeated. By default {', '.join(HELD_OUT)}."
        ),
    ] = [],  # noqa: B006
    rooms: Annotated[int, typer.Option(metavar="N", min=1, help="Rooms to fit to.")] = 8,
    steps: Annotated[int, typer.Option(metavar="N", min=1, help="Trials of each fit.")] = 80,
    size: Annotated[str, typer.Option(metavar="WxH", help="Size of the frames.")] = "192x108",
    spp: Annotated[int, typer.Option(metavar="N", min=2, help="Samples per pixel of a truth.")] = 64,
    markdown_: Annotated[bool, typer.Option("--markdown", help="Print tables as markdown.")] = False,
) -> None:
    """Fit settings to random rooms, and measure the gain on other scenes.

    PYOPENCL_CTX chooses the device. Truths are stored in the user's cache folder.
    """
    chosen = filters or list(FITTED)
    for name in chosen:
        if name not in FITTED:
            raise SvgfError(f"expected filters out of {', '.join(FITTED)}, got {name}")
    choice = Choice(parse_size(size), FRAMES, JUDGED, spp, jitter=False)
    learned = rendered([RoomFootage(str(seed), choice) for seed in range(rooms)], "rooms")
    judged = rendered([open_footage(name, choice) for name in held_out or HELD_OUT], "scenes to judge by")
    rows = []
    for name in chosen:
        usual = FILTERS[name]()
        found = fitted(usual, FITTED[name], learned, steps)
        gains = [each.badness(usual) - each.badness(found) for each in judged]
        inside = badness(usual, learned) - badness(found, learned)
        values = ", ".join(f"{key} {getattr(usual, key):g} → {getattr(found, key):.3g}" for key in FITTED[name])
        rows.append([name, values, f"{inside:+.2f}", *(f"{gain:+.2f}" for gain in gains)])
    columns = ("filter", "settings", "rooms", *(each.name for each in judged))
    table = Table("bits gained: of error and of temporal error together", columns, rows)
    print(markdown(table)) if markdown_ else show(table.title, table.columns, table.rows, 2)
    about = provenance(devices.default_device()) | {"size": size, "truth": f"{spp} spp"}
    print("\n".join(f"{key}: {value}" for key, value in about.items()))


def rendered(footages: Sequence[Traced], title: str) -> list[Clip]:
    """All sequences, in memory."""
    with progress_bar(title, sum(each.steps for each in footages)) as advance:
        return [Clip.of(each, advance) for each in footages]


def badness(settings: Filter, clips: Sequence[Clip]) -> float:
    """Mean of a filter's badness over sequences."""
    return float(np.mean([clip.badness(settings) for clip in clips]))


def fitted(usual: Filter, names: Sequence[str], clips: Sequence[Clip], steps: int) -> Filter:
    """The filter with the best settings `names` for these clips; it is never worse there than `usual`."""
    from scipy.optimize import minimize

    begin = np.log2([getattr(usual, name) for name in names])
    corners = np.vstack([begin, begin + FIRST_STEP * np.eye(len(names))])
    with progress_bar(f"fitting {usual.name}", steps) as advance:

        def tried(values: Vector) -> float:
            advance()
            return badness(moved(usual, names, values), clips)

        found = minimize(
            tried, begin, method="Nelder-Mead", options={"maxfev": steps, "initial_simplex": corners, "xatol": 0.02}
        )
    return moved(usual, names, found.x)


def moved(usual: Filter, names: Sequence[str], values: Vector) -> Filter:
    """The filter with settings of these binary logarithms, clamped to their ranges."""
    ranges = domains(type(usual))
    wanted = {}
    for name, value in zip(names, values, strict=True):
        span = ranges[name]
        if not isinstance(span, Range):
            raise SvgfError(f"{name}: expected a number, got {span}")
        wanted[name] = float(np.clip(2.0**value, span.least, span.greatest))
    return replace(usual, **wanted)


def main() -> None:
    """Run the command."""
    run(fit, "benchmarks.fit")


if __name__ == "__main__":
    main()
