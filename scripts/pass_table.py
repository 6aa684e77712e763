"""Writes the tables of passes and buffers of every filter into docs/algorithm.md, from the filters' declarations."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

from svgf_cl.bench.cost import cost
from svgf_cl.device.memory_plan import memory_slots
from svgf_cl.filters import FILTERS
from svgf_cl.filters.filter import Filter
from svgf_cl.filters.pipeline import OUT, Access, Buffer, Life, Pass, Pipeline, Quantity, Resource, Use
from svgf_cl.filters.signals import Inputs
from svgf_cl.filters.taps import HERE, Taps
from svgf_cl.io.atomic import write_text

TARGET = Path("docs/algorithm.md")
BEGIN = "<!-- From here on made by `make docs` (`python scripts/pass_table.py`); do not edit. -->"
END = "<!-- Down to here made by `make docs`. -->"

INPUTS = Inputs(motion=3, albedo=True, emission=True, id=True)

INTRODUCTION = f"""
The tables are for default settings with `taa`, and frames with {INPUTS}.

- A tap is written as `quantity@pixels`: `depth@5±1` means the depth at 5 pixels, each at most 1 pixel away along a
  row or a column.
  `@4 moved` means 4 pixels around the position of the pixel in the previous frame.
  A quantity without `@` is read at the pixel itself.
- "previous" marks a buffer that the previous frame wrote.
- "numbers" are the settings that the kernel gets, with their defaults; levels after the first list only differences.
- Operations and bytes are those of one pixel in a steady state, as [benchmarks.md](benchmarks.md#roofline) counts them:
  each plane that a pass needs is read once, and neighbours come from a cache.
"""

LIVES = {Life.SCRATCH: "this frame", Life.HISTORY: "next frame", Life.PAIR: "next frame, two halves that alternate"}


def tables() -> str:
    """The text between the two marks."""
    return "\n".join([INTRODUCTION, *(part for kind in FILTERS.values() for part in section(kind))])


def section(kind: type[Filter]) -> Iterable[str]:
    """The passes, buffers and memory of one filter."""
    pipeline = kind(taa=True).pipeline(INPUTS)  # type: ignore[call-arg]
    yield f"### Passes of `{kind.name}`\n"
    heads: tuple[str, ...] = ("pass", "source", "reads", "writes", "numbers", "operations", "bytes")
    first = {entry.kernel: entry for entry in reversed(pipeline.passes)}
    yield table(heads, [pass_row(entry, first[entry.kernel]) for entry in pipeline.passes])
    yield f"### Buffers of `{kind.name}`\n"
    heads = ("buffer", "quantities", "format", "bytes a pixel", "needed until", "may be written over")
    yield table(heads, [buffer_row(resource) for resource in pipeline.resources])
    yield memory(pipeline)


def pass_row(entry: Pass, first: Pass) -> list[str]:
    """The row of a pass; of its numbers, only those that differ from the `first` pass of its kind."""
    spent = cost(entry)
    own = entry.scalars.items() if entry is first else entry.scalars.items() - first.scalars.items()
    numbers = ", ".join(f"{name} = {value:g}" for name, value in own)
    reads, writes = (joined(map(shown, accesses)) for accesses in (entry.reads, entry.writes))
    return [entry.label, f"`{entry.source}.cl`", reads, writes, numbers, f"{spent.flops:g}", f"{spent.bytes:g}"]


def shown(access: Access) -> str:
    """What a pass reads or writes of a buffer or user's array; empty if the access does not count."""
    if isinstance(access.of, Buffer):
        return f"{access.of}: {', '.join(map(tapped, access.uses))}" if access.uses else ""
    return "the result" if access.of == OUT else f"`Frame.{access.of}`"


def tapped(use: Use) -> str:
    """A quantity, and the pixels where it is needed."""
    return use.quantity.name + taps_text(use.taps)


def taps_text(taps: Taps) -> str:
    """The text about pixels after a quantity's name."""
    if taps == HERE:
        return ""
    return f"@{len(taps.offsets)}" + (" moved" if taps.follow_motion else f"±{taps.reach}")


def buffer_row(resource: Resource) -> list[str]:
    """The row of a buffer."""
    formats = dict.fromkeys(str(quantity.format.dtype) for quantity in resource.quantities)
    size = f"{sum(quantity.nbytes for quantity in resource.quantities) / resource.spacing**2:g}"
    quantities = ", ".join(map(planes_text, resource.quantities))
    return [resource.name, quantities, ", ".join(formats), size, LIVES[resource.life], resource.over]


def planes_text(quantity: Quantity) -> str:
    """A quantity, and its number of channels."""
    return quantity.name if quantity.planes == 1 else f"{quantity.name} ({quantity.planes})"


def memory(pipeline: Pipeline) -> str:
    """The total memory, and which buffers share the same memory."""
    slots = memory_slots(pipeline)
    shared = [", ".join(map(str, slot.buffers)) for slot in slots if len(slot.buffers) > 1]
    total = sum(slot.planes.depth / slot.spacing**2 for slot in slots) / 8
    turns = "; ".join(shared) or "none"
    return f"{total:g} bytes a pixel in total. Buffers that share the same memory: {turns}.\n"


def joined(parts: Iterable[str]) -> str:
    """The parts that are not empty, joined."""
    return "; ".join(filter(None, parts))


def table(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table in Markdown."""
    lines = [heads, ["---"] * len(heads), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines) + "\n"


def page(now: str) -> str:
    """The page with new tables between the marks."""
    before, begin, rest = now.partition(BEGIN)
    _, end, after = rest.partition(END)
    if not (begin and end):
        raise ValueError(f"expected {BEGIN!r} and {END!r} behind it in {TARGET}")
    return f"{before}{BEGIN}\n{tables()}\n{END}{after}"


def main() -> None:
    """Write the page."""
    write_text(TARGET, page(TARGET.read_text()))
    print(TARGET)


if __name__ == "__main__":
    main()
