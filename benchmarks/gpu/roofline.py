"""The best that GPUs could do, computed from the filters' declarations and published limits; nothing is measured.

python -m benchmarks.gpu.roofline                           # prints the tables
python -m benchmarks.gpu.roofline docs/gpu.md               # writes them into the page
python -m benchmarks.gpu.roofline [docs/gpu.md] --counts out/gpu_static/kernels.json    # with compiled instructions
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated

import typer

from benchmarks import command
from benchmarks.gpu.limits import GPUS, PCI_EXPRESS, Gpu
from benchmarks.presentation import markdown
from svgf_cl import Kalman, Settings
from svgf_cl.bench.cases import ROOM
from svgf_cl.bench.cost import Cost, cost
from svgf_cl.bench.roofline import Bound
from svgf_cl.bench.tables import Table
from svgf_cl.device.tuning import GPU_TUNING
from svgf_cl.errors import FileError
from svgf_cl.filters.filter import Filter
from svgf_cl.filters.pipeline import OUT, Access, Buffer, Pass, Use
from svgf_cl.frame import Shape, extent
from svgf_cl.io.atomic import read_json, unreadable, write_text

SHAPES: tuple[Shape, ...] = ((720, 1280), (1080, 1920), (2160, 3840))
USUAL: Shape = (1080, 1920)
FILTERS: tuple[Filter, ...] = (Kalman(), Settings())
LAUNCH = 5e-6  # seconds to launch a kernel; assumed, because this depends on the driver
MARKS = "<!-- From here on made by `python -m benchmarks.gpu.roofline {}`; do not edit. -->", "<!-- Down to here. -->"
COUNTS = "--counts out/gpu_static/kernels.json"  # what `make gpu-static` writes

Change = Callable[[Pass], Pass]
Counts = Mapping[tuple[str, str, str], int]  # instructions per pixel by filter, kernel and architecture


@dataclass(frozen=True)
class Bounded:
    """A pass on a GPU.

    Parameters
    ----------
    entry : Pass
    spent : Cost
        The cost per pixel.
    bound : Bound
        The bound for an image.
    working_set : float, bytes
        The bytes used between the writing of a byte and its reading.
    """

    entry: Pass
    spent: Cost
    bound: Bound
    working_set: float


def unchanged(entry: Pass) -> Pass:
    """The pass without changes."""
    return entry


def bounded(chosen: Filter, shape: Shape, gpu: Gpu, change: Change = unchanged) -> list[Bounded]:
    """All passes of a filter with their bounds; the pass before the first one is the last of the previous frame."""
    passes = [change(entry) for entry in chosen.pipeline(ROOM).passes]
    spent = [cost(entry) for entry in passes]
    whole = [each * (shape[0] * shape[1]) for each in spent]
    return [
        Bounded(entry, own, Bound.of(now, before, gpu.ceilings), 0.5 * (before.bytes + now.bytes))
        for entry, own, now, before in zip(passes, spent, whole, [whole[-1], *whole[:-1]], strict=True)
    ]


def seconds(chosen: Filter, shape: Shape, gpu: Gpu, change: Change = unchanged) -> float:
    """The shortest possible time of a frame."""
    return sum(each.bound.seconds for each in bounded(chosen, shape, gpu, change))


def octahedral(entry: Pass) -> Pass:
    """The pass with normals in one plane of two 16-bit numbers, instead of three planes of 32 bits."""

    def packed(each: Access) -> Access:
        if not isinstance(each.of, Buffer):
            return each
        uses = [
            replace(use, quantity=replace(use.quantity, channels=1)) if use.quantity.name == "normal" else use
            for use in each.uses
        ]
        return replace(each, uses=tuple(uses))

    return replace(entry, reads=tuple(map(packed, entry.reads)), writes=tuple(map(packed, entry.writes)))


def limits() -> Table:
    """The published limits of each GPU."""
    heads = ("GPU", "memory GB/s", "cache MB", "cache GB/s", "nearest caches GB/s", "TFLOP/s", "sources")
    rows = [
        (
            each.name,
            *(f"{value:.0f}" for value in (1e-9 * each.memory, 1e-6 * each.cache, 1e-9 * each.cache_bandwidth)),
            f"{1e-9 * each.loads:.0f}",
            f"{1e-12 * each.flops:.1f}",
            each.sources,
        )
        for each in GPUS
    ]
    return Table("Published limits", heads, rows)


def passes(chosen: Filter) -> Table:
    """Each pass: its cost per pixel, and its bound on each GPU."""
    found = [bounded(chosen, USUAL, gpu) for gpu in GPUS]
    rows = []
    for same in zip(*found, strict=True):
        spent = same[0].spent
        counted = (f"{value:.0f}" for value in (spent.bytes, spent.loads.bytes, spent.flops))
        rows.append(
            (same[0].entry.label, *counted, *(f"{1e6 * each.bound.seconds:.1f} {each.bound.binds}" for each in same))
        )
    totals = [
        sum(value)
        for value in zip(*((e.spent.bytes, e.spent.loads.bytes, e.spent.flops) for e in found[0]), strict=True)
    ]
    sums = (f"{1e6 * sum(each.bound.seconds for each in column):.0f}" for column in found)
    rows.append(("all", *(f"{value:.0f}" for value in totals), *sums))
    heads = ("pass", "bytes/px", "loaded/px", "flop/px", *(f"{gpu.name}, µs" for gpu in GPUS))
    return Table(f"`{chosen.name}` at {extent(USUAL)}: bound of each pass, and what binds it", heads, rows)


def frames() -> Table:
    """The bound of a frame at each size, and the time for launches."""
    rows = []
    for chosen in FILTERS:
        for shape in SHAPES:
            found = [bounded(chosen, shape, gpu) for gpu in GPUS]
            cells = (
                f"{1e3 * sum(each.bound.seconds for each in column):.3f}, {in_cache(column, gpu)}"
                for gpu, column in zip(GPUS, found, strict=True)
            )
            launches = len(found[0])
            rows.append((chosen.name, extent(shape), *cells, f"{launches}: {1e3 * LAUNCH * launches:.3f}"))
    heads = ("filter", "size", *(f"{gpu.name}, ms" for gpu in GPUS), "launches, ms")
    return Table(
        "A frame: the sum of its passes' bounds, and how many of them find their input in the cache", heads, rows
    )


def in_cache(column: Sequence[Bounded], gpu: Gpu) -> str:
    """How many passes find the output of the previous pass in the cache."""
    return f"{sum(each.working_set <= gpu.cache for each in column)} of {len(column)} in cache"


def changes() -> Table:
    """The bytes and the bound of a frame with other storage."""
    options: dict[str, tuple[Filter, Change]] = {
        "as it is": (Kalman(), unchanged),
        "`half_guides` (an option)": (Kalman(half_guides=True), unchanged),
        "`half_history` (an option)": (Kalman(half_history=True), unchanged),
        "both (an option)": (Kalman(half_guides=True, half_history=True), unchanged),
        "octahedral normals, 2 x 16 bits": (Kalman(), octahedral),
        "`half_history` and octahedral normals": (Kalman(half_history=True), octahedral),
    }
    rows = []
    for name, (chosen, change) in options.items():
        spent = [cost(change(entry)) for entry in chosen.pipeline(ROOM).passes]
        moved, loaded = sum(each.bytes for each in spent), sum(each.loads.bytes for each in spent)
        bounds = (f"{1e3 * seconds(chosen, USUAL, gpu, change):.3f}" for gpu in GPUS)
        rows.append((name, f"{moved:.0f}", f"{loaded:.0f}", *bounds))
    heads = ("storage", "bytes/px", "loaded/px", *(f"{gpu.name}, ms" for gpu in GPUS))
    return Table(f"`kalman` at {extent(USUAL)} with other storage", heads, rows)


def reuse() -> Table:
    """The share of the loads of a work-group that are distinct: a tile in local memory would load each pixel once.

    The rows of a work-group are one step of the level apart, as its taps are.
    """
    along, down = GPU_TUNING.work_group
    pixels = USUAL[0] * USUAL[1]
    rows = []
    for each in bounded(Kalman(), USUAL, GPUS[0]):
        if each.entry.kernel != "atrous":
            continue
        uses = [use for access in each.entry.reads for use in access.uses]
        read = sum(use.quantity.nbytes * distinct(use, along, down, each.entry.row_step) for use in uses)
        written = sum(use.quantity.nbytes for access in each.entry.writes for use in access.uses)
        moved = read / (along * down) + written
        times = (f"{1e6 * moved * pixels / gpu.cache_bandwidth:.1f}" for gpu in GPUS)
        rows.append(
            (
                str(each.entry.level),
                f"{each.spent.loads.bytes:.0f}",
                f"{moved - written:.0f}",
                *times,
                f"{1e-3 * read:.1f}",
            )
        )
    heads = ("level", "loaded/px", "distinct/px", *(f"{gpu.name}, µs from its cache" for gpu in GPUS), "tile, kB")
    return Table(f"A-trous levels of `kalman` at {extent(USUAL)} in work-groups of {along}x{down}", heads, rows)


def distinct(use: Use, along: int, down: int, row_step: int) -> int:
    """The number of distinct pixels of a quantity that a work-group reads."""
    items = [(x, y * row_step) for x in range(along) for y in range(down)]
    return len({(x + dx, y + dy) for x, y in items for dx, dy in use.taps.offsets})


def uploads() -> Table:
    """The time for copying a frame's arrays to the device and the picture back, over the bus."""
    by_name = Kalman().pipeline(ROOM).user_nbytes
    sent = sum(nbytes for name, nbytes in by_name.items() if name != OUT)
    rows = [
        (
            extent(shape),
            *(f"{1e-6 * nbytes * shape[0] * shape[1]:.0f}" for nbytes in (sent, by_name[OUT])),
            *(f"{1e3 * sent * shape[0] * shape[1] / speed:.2f}" for speed in PCI_EXPRESS.values()),
        )
        for shape in SHAPES
    ]
    heads = ("size", "sent, MB", "back, MB", *(f"sent by {bus}, ms" for bus in PCI_EXPRESS))
    return Table(f"Arrays of a frame with {ROOM}: {sent} bytes a pixel sent, {by_name[OUT]} back", heads, rows)


def instructions(chosen: Filter, counts: Counts) -> Table:
    """Compiled instructions of each pass, and the shortest time to issue them, beside the roofline's time."""
    found = [bounded(chosen, USUAL, gpu) for gpu in GPUS]
    pixels = USUAL[0] * USUAL[1]
    rows = []
    sums = [0.0 for _ in GPUS]
    for same in zip(*found, strict=True):
        entry = same[0].entry
        cells = []
        for index, (gpu, each) in enumerate(zip(GPUS, same, strict=True)):
            count = counts.get((chosen.name, entry.kernel, gpu.architecture))
            issue = (count or 0) * pixels / entry.spacing**2 / gpu.instructions
            sums[index] += max(issue, each.bound.seconds)
            cells += ["-" if count is None else str(count), f"{1e6 * issue:.1f} / {1e6 * each.bound.seconds:.1f}"]
        rows.append((entry.label, *cells))
    rows.append(("all, the longer of both", *(cell for each in sums for cell in ("", f"{1e6 * each:.0f}"))))
    heads = ("pass", *(part for gpu in GPUS for part in (gpu.architecture, f"{gpu.name}, µs")))
    title = f"`{chosen.name}` at {extent(USUAL)}: instructions a work-item; time to issue them / the roofline's"
    return Table(title, heads, rows)


def read_counts(path: Path) -> tuple[Counts, str]:
    """Read the instruction counts of ``benchmarks.gpu_static`` for default filters, and the versions of the compilers.

    Kernels that several filters share are counted once, under the name of one of them.

    Raises
    ------
    FileError
        If it cannot be read or is another kind of file.
    """
    try:
        document = read_json(path)
        entries, about = document["kernels"], ", ".join(f"{key} {value}" for key, value in document["about"].items())
        found: dict[tuple[str, str, str], int] = {}
        for chosen in FILTERS:
            own = f"{chosen.name} by default"
            # the filter's own first
            for entry in sorted(entries, key=lambda entry: not entry["variant"].startswith(own)):
                place = (chosen.name, entry["kernel"], entry["architecture"])
                found.setdefault(place, int(entry["instructions"]["total"]))
    except OSError as error:
        raise unreadable(path, error) from error
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise FileError(
            f"{path}: expected kernels.json of 'python -m benchmarks.gpu_static', got something else ({error!r})"
        ) from error
    return found, about


def all_tables() -> Iterator[Table]:
    """All tables that need no counts, in the order of the page."""
    yield from (limits(), frames(), *map(passes, FILTERS), changes(), reuse(), uploads())


def text(tables: Sequence[Table]) -> str:
    """Tables under their titles, in Markdown."""
    return "\n".join(f"{table.title}:\n\n{markdown(table)}" for table in tables)


def put(page: str, arguments: str, made: str) -> str:
    """Replace the text between the marks for these arguments by `made`."""
    begin, end = MARKS[0].format(arguments), MARKS[1]
    before, found, rest = page.partition(begin)
    _, closed, after = rest.partition(end)
    if not (found and closed):
        raise FileError(f"expected {begin!r} and {end!r} behind it in the page, found neither or one")
    return f"{before}{begin}\n\n{made}\n{end}{after}"


def roofline(
    page: Annotated[Path | None, typer.Argument(help="A page to write the tables into, between its marks.")] = None,
    counts: Annotated[
        Path | None, typer.Option(metavar="FILE", help="kernels.json of python -m benchmarks.gpu_static; adds a table.")
    ] = None,
) -> None:
    """Compute the shortest possible times from the filters' declarations and published limits of GPUs."""
    made = {"docs/gpu.md": text([*all_tables()])}
    if counts:
        found, about = read_counts(counts)
        tables = [instructions(chosen, found) for chosen in FILTERS]
        made[f"docs/gpu.md {COUNTS}"] = f"Compiled by {about}.\n\n{text(tables)}"
    if page is None:
        print("\n".join(made.values()))
        return
    now = page.read_text(encoding="utf-8")
    for arguments, part in made.items():
        now = put(now, arguments, part)
    write_text(page, now)


if __name__ == "__main__":
    command.run(roofline, "benchmarks.gpu.roofline")
