"""What is said of frames before they are denoised: the fields that are read, and what is wrong in the first frames."""

from __future__ import annotations

import warnings
from collections.abc import Collection
from pathlib import Path

import numpy as np

from svgf_cl.check import Inspection
from svgf_cl.check.values import SEEN
from svgf_cl.check.view import FAR, has_normal, in_range
from svgf_cl.errors import FileError
from svgf_cl.frame import CARRIED, Frame
from svgf_cl.io.frames import CHANNEL_NAMES, OPTIONAL, needed
from svgf_cl.io.look_alikes import advice, grouped

FIRST = 8  # frames that are checked; they tell nearly all that more would
# What it costs not to have a field.
COSTS = {
    "albedo": "textures are smoothed like light",
    "id": "objects are told apart by depth and normal alone",
    "emission": "what shines is smoothed too",
    "direct and indirect": "they are filtered as one",
    OPTIONAL: "history is lost where the camera moves along its axis",
}


def reading(channels: Collection[str]) -> str:
    """Say in one line which fields are read from which of a file's channels, and which are missing."""
    there = {field: names for field, all_ in CHANNEL_NAMES.items() if (names := [c for c in all_ if c in channels])}
    split = "direct" in there
    unused = [field for field in there if field in CARRIED or (split and field == "color")]
    read = [f"{field} ({grouped(names)})" for field, names in there.items() if field not in unused]
    parts = [f"read: {', '.join(read)}"]
    missing = [field for field in ("albedo", "id", "emission") if field not in there]
    missing += [] if split else ["direct and indirect"]
    missing += [] if OPTIONAL in channels else [OPTIONAL]
    if missing:
        parts.append(f"missing: {', '.join(f'{field} ({COSTS[field]})' for field in missing)}")
    if unused:
        parts.append(f"not needed: {', '.join(unused)}")
    hint = advice(channels, {field: needed(field) for field in CHANNEL_NAMES if field not in there})
    return "; ".join([*parts, *([f"ignored: {hint}"] if hint else [])])


class FirstFrames:
    """Looks at the first frames of a shot as they come, and warns of what is wrong with them.

    Parameters
    ----------
    total : int
        The length of the shot.
    """

    def __init__(self, total: int) -> None:
        self._left = min(FIRST, total)
        self._inspection = Inspection()

    def look(self, frame: Frame, *, after_cut: bool) -> None:
        """Look at the next frame; after the last of the first ones, warn."""
        if not self._left:
            return
        if after_cut:
            self._inspection.cut()
        self._inspection.add(frame)
        self._left -= 1
        if not self._left:
            self._warn()
            self._inspection = Inspection()  # what it held is free

    def _warn(self) -> None:
        report = self._inspection.report()
        found = [f"{finding.field}: {finding.what}; {finding.cure}" for finding in report.findings]
        if not any(finding.field == "depth" for finding in report.findings):
            found += [f"depth: {unknown.why}" for unknown in report.unknown if unknown.topic == SEEN.topic]
        for line in found:
            warnings.warn(line, stacklevel=2)
        if found:
            warnings.warn("told from the first frames; svgf-cl check says more, --no-check leaves it out", stacklevel=2)


def require_surfaces(path: Path, frame: Frame) -> None:
    """Raise `FileError` where all depth is negative: nothing would be filtered."""
    seen = has_normal(frame.normal)
    behind, hit = -frame.depth[seen & (frame.depth < 0)], frame.depth[seen & in_range(frame.depth)]
    # A great number may stand for a miss.
    if behind.size and not (hit < FAR * np.median(behind)).any():
        raise FileError(
            f"{path}: expected depth above 0 where there is a surface, got it negative everywhere; "
            "negate the z of a camera that looks along -z"
        )
