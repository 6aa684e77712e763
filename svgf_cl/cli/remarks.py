"""Remarks on frames before they are denoised: the fields that were found, and mistakes in the first frames."""

from __future__ import annotations

import warnings
from pathlib import Path

import numpy as np

from svgf_cl.check import Inspection
from svgf_cl.check.noise import lacks_motion
from svgf_cl.check.values import SEEN
from svgf_cl.check.view import FAR, has_normal, in_range
from svgf_cl.errors import FileError
from svgf_cl.frame import CARRIED, Frame
from svgf_cl.io.look_alikes import advice, grouped
from svgf_cl.io.readers.own import CHANNEL_NAMES, OPTIONAL, OWN, needed
from svgf_cl.io.shot import Shot, ShotFrame, fields_of

FIRST = 8  # frames that are checked; more would find little else
# The consequences of a missing field.
COSTS = {
    "albedo": "textures are smoothed like light",
    "id": "objects are distinguished only by depth and normal",
    "emission": "lamps and sky are smoothed too",
    OPTIONAL: "history is lost where the camera moves along its axis",
}
PARTS = ("direct", "indirect")  # parts of the light, which `Reading.lights` has
UNUSED = (*CARRIED, *PARTS, "motion_to_next")


def described(shot: Shot, first: ShotFrame) -> str:
    """Return a line that says how the frames are read, from which channels each field, and which are missing."""
    reading = shot.reading
    names = {field: found[1] for field, found in reading.sources.items() if field not in UNUSED}
    light = [light.channels for light in reading.lights if light.filtered]
    files = {field: next(iter(paths.values())).name for field, paths in shot.separate.paths.items()}
    read = ", ".join(f"{name} ({files.get(name) or grouped(channels)})" for name, channels in names.items())
    parts = [f"read as frames of {reading.reader.title}: {read}"]
    if shot.camera_file:
        parts.append(f"cameras: {shot.camera_file}")
    if light:
        parts.append(f"light passes: {', '.join(grouped(each) for each in light)}")
    there = {*fields_of(first.frame), *(["emission"] if reading.lights else [])}
    missing = [field for field in COSTS if field not in there]
    if missing:
        parts.append(f"missing: {', '.join(f'{field} ({COSTS[field]})' for field in missing)}")
    unread = [channel for channel in first.image.planes if not any(channel in found for found in names.values())]
    if reading.reader is OWN:  # other renderers' further passes are known
        hint = advice(unread, {field: needed(field) for field in CHANNEL_NAMES if field not in (*names, *PARTS)})
        parts += [f"ignored: {hint}"] if hint else []
    return "; ".join(parts)


BLURRED = "each frame is denoised alone; with motion blur, renderers write no motion: turn it off, and blur later"


class Remarks:
    """Prints how the first frame is read, and warns of mistakes in the first few frames.

    Parameters
    ----------
    total : int
        The length of the shot.
    check : bool
        Whether to warn.
    """

    def __init__(self, total: int, *, check: bool) -> None:
        self._left = min(FIRST, total) if check else 0
        self._is_first = True
        self._lacks_motion = False
        self._last: Frame | None = None
        self._inspection = Inspection()

    def look(self, shot: Shot, index: int, source: ShotFrame) -> None:
        """Look at the next frame; raise `FileError` if it cannot be denoised."""
        look_at_surfaces(shot, index, source)
        if self._is_first:
            print(described(shot, source))
            self._is_first = False
        if not self._left:
            return
        if index in shot.cuts:
            self._inspection.cut()
        self._inspection.add(source.frame)
        self._lacks_motion |= self._last is not None and lacks_motion(source.frame, self._last)
        self._last = source.frame
        self._left -= 1
        if not self._left:
            self._warn()
            self._inspection, self._last = Inspection(), None  # frees their memory

    def look_at_first(self, shot: Shot, places: range) -> None:
        """Look at the first frames of a shot before any frame is denoised."""
        for index in places[: max(1, self._left)]:
            self.look(shot, index, shot.read(index))

    def _warn(self) -> None:
        report = self._inspection.report()
        found = [f"{finding.field}: {finding.what}; {finding.cure}" for finding in report.findings]
        if not any(finding.field == "depth" for finding in report.findings):
            found += [f"depth: {unknown.why}" for unknown in report.unknown if unknown.topic == SEEN.topic]
        if self._lacks_motion:
            found.append(f"motion: 0 in all pixels, but objects move; {BLURRED}")
        for line in found:
            warnings.warn(line, stacklevel=2)
        if found:
            warnings.warn(
                "these warnings are about the first frames; svgf-cl check says more, --no-check turns them off",
                stacklevel=2,
            )


def look_at_surfaces(shot: Shot, index: int, source: ShotFrame) -> None:
    """Raise `FileError` if a frame cannot be denoised."""
    require_surfaces(source.path, source.frame)


def require_surfaces(path: Path, frame: Frame) -> None:
    """Raise `FileError` if all depth is negative: nothing would be filtered."""
    seen = has_normal(frame.normal)
    behind, hit = -frame.depth[seen & (frame.depth < 0)], frame.depth[seen & in_range(frame.depth)]
    # A great number may mean a miss.
    if behind.size and not (hit < FAR * np.median(behind)).any():
        raise FileError(
            f"{path}: expected depth above 0 on surfaces, got negative depth everywhere; "
            "negate the z of a camera that looks along -z"
        )
