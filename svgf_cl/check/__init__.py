"""Finds common mistakes in a renderer's frames, from the frames alone.

`check_frame` and `check_sequence` measure each frame with every `Check` of `CHECKS`, and judge the sums over frames.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from svgf_cl.check import alignment, camera, depth, motion, shading, surfaces, values
from svgf_cl.check.check import Check
from svgf_cl.check.finding import Finding, Report, Unknown
from svgf_cl.check.view import Array, View
from svgf_cl.frame import Frame

__all__ = ["CHECKS", "Finding", "Report", "Unknown", "check_frame", "check_sequence"]

# Fields that other checks need are checked first.
CHECKS = (
    values.FINITE,
    values.NEGATIVE,
    values.FILLED,
    alignment.UPRIGHT,
    alignment.PUNCTUAL,
    values.LENGTH,
    depth.ENCODING,
    motion.DIRECTION,
    surfaces.DEEPER,
    camera.JITTER,
    surfaces.WORLD,
    surfaces.NAMES,
    values.ALBEDO,
    values.ROUGHNESS,
    shading.CURVE,
    values.RANGE,
    shading.SHINING,
    shading.PARTS,
    values.MISSES,
    values.SEEN,
)


def check_frame(frame: Frame, previous: Frame | None = None) -> Report:
    """Find mistakes in a frame, alone and compared with the previous one.

    Parameters
    ----------
    frame : Frame
        Its fields are numpy or pyopencl arrays.
    previous : Frame, optional
        The previous frame; without it, motion and everything that must stay the same over time are not checked.

    Returns
    -------
    Report

    Raises
    ------
    FrameError
        If a field is missing, or has a shape or type that the denoiser does not accept.

    Notes
    -----
    More frames allow many more checks; see `check_sequence`.
    """
    return check_sequence([frame] if previous is None else [previous, frame])


def check_sequence(frames: Iterable[Frame]) -> Report:
    """Find mistakes in consecutive frames of a shot.

    Parameters
    ----------
    frames : iterable of Frame
        In order, without a cut; two are in memory at a time. Eight frames of a moving camera are enough.

    Returns
    -------
    Report

    Raises
    ------
    FrameError
        If a field is missing, or has a shape or type that the denoiser does not accept.
    """
    inspection = Inspection()
    for frame in frames:
        inspection.add(frame)
    return inspection.report()


class Inspection:
    """Runs all checks on the frames of a shot, which are added one by one; two are in memory at a time."""

    def __init__(self) -> None:
        self._sums: dict[Check, Array] = {}
        self._views: list[View] = []
        self._run = self._longest = 0

    def add(self, frame: Frame) -> None:
        """Measure the next frame; raise `FrameError` as `check_sequence` does."""
        frame.check(self._views[-1].frame.shape if self._views else frame.shape)
        self._run += 1
        self._longest = max(self._longest, self._run)
        with np.errstate(all="ignore"):  # frames may hold anything
            self._views = [*self._views[-1:], View.of(frame)]
            for check in CHECKS:
                told = check.ask(self._views)
                if told is not None:
                    self._sums[check] = self._sums.get(check, 0) + told

    def cut(self) -> None:
        """Begin a new shot with the next frame."""
        self._views, self._run = [], 0

    def report(self) -> Report:
        """Return the report on the frames so far."""
        return judged(self._sums, self._longest)


def judged(sums: dict[Check, Array], count: int) -> Report:
    """Return the report from sums over frames, of which at most `count` were consecutive."""
    findings: list[Finding] = []
    unknown: list[Unknown] = []
    passed: list[str] = []
    for check in CHECKS:
        wrong = {finding.field for finding in findings if finding.severity == "error"}
        told = check.verdict(sums.get(check), wrong, count)
        findings += [verdict for verdict in told if isinstance(verdict, Finding)]
        unknown += [verdict for verdict in told if isinstance(verdict, Unknown)]
        passed += [] if told else [check.topic]
    looked_at = {check.topic: check.looked_at(total) for check, total in sums.items() if check.fields}
    return Report(tuple(findings), tuple(unknown), tuple(passed), looked_at)
