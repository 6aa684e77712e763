"""Scenes rendered once for several tests."""

from __future__ import annotations

import functools
from collections.abc import Sequence

from benchmarks.mistakes import Taken, good_sequence
from svgf_cl.check.check import Check
from svgf_cl.check.finding import Finding, Unknown
from svgf_cl.check.view import View
from svgf_cl.frame import Frame

SHAPE = (180, 320)
FRAMES = 5


@functools.cache
def good(scene: str) -> Sequence[Taken]:
    """Frames as they should be."""
    return good_sequence(scene, SHAPE, FRAMES)


def asked(check: Check, frames: Sequence[Frame]) -> Sequence[Finding | Unknown]:
    """What one check alone says of frames."""
    views = [View.of(frame) for frame in frames]
    told = [check.ask(views[: end + 1]) for end in range(len(views))]
    return check.judge(sum(sums for sums in told if sums is not None))
