"""How far around a part of an image each pass must be right, so that the part itself is: by the taps of all passes."""

from __future__ import annotations

from collections import defaultdict

from svgf_cl.filters.pipeline import Buffer, Pipeline


def margins(pipeline: Pipeline) -> tuple[int, ...]:
    """Pixels around a part of the image at which the results of each pass must be right, in the order of the passes.

    What lasts and what the user gets is wanted at the part alone. From there on backwards, whatever makes a buffer
    must be right wherever a later pass reads it. What a pass reads along motion does not count: it is of another frame.
    """
    wanted: defaultdict[Buffer | str, int] = defaultdict(int)
    found = []
    for entry in reversed(pipeline.passes):
        margin = max(wanted[each.of] for each in entry.writes)
        found.append(margin)
        past = pipeline.past_of(entry)
        for each in entry.reads:
            if each not in past:
                wanted[each.of] = max(wanted[each.of], margin + entry.reach(each))
    return tuple(reversed(found))


def widest_margin(pipeline: Pipeline) -> int:
    """Pixels around a part of the image that are read to make it."""
    return max(
        margin + entry.reach(each)
        for entry, margin in zip(pipeline.passes, margins(pipeline), strict=True)
        for each in entry.reads
    )
