"""The margin around a part of an image that each pass has to compute, so that the part itself is right."""

from __future__ import annotations

from collections import defaultdict

from svgf_cl.filters.pipeline import Buffer, Pipeline


def margins(pipeline: Pipeline) -> tuple[int, ...]:
    """The margin in pixels in which each pass must have right results, in the order of the passes.

    The results and the history are needed in the part only. Going backwards from there, each pass must be right
    wherever a later pass reads its results. Taps along motion do not count, because they read the previous frame.
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
    """The margin in pixels around a part of the image that the passes read to compute it."""
    return max(
        margin + entry.reach(each)
        for entry, margin in zip(pipeline.passes, margins(pipeline), strict=True)
        for each in entry.reads
    )
