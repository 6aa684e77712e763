"""Checks of what a renderer hands over: which of the usual mistakes are in some frames, told from the frames alone.

`check_frame` and `check_sequence` ask every `Check` of `CHECKS` what each frame says; the sums over frames are judged.
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

# What others trust comes first.
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
    """Look for what is wrong with a frame, by itself and beside the one before it.

    Parameters
    ----------
    frame : Frame
        Of numpy or pyopencl arrays.
    previous : Frame, optional
        The frame before; without it motion, and whatever is to stay the same over time, cannot be told.

    Returns
    -------
    Report

    Raises
    ------
    FrameError
        A field is missing, or of another shape or type than the denoiser takes.

    Notes
    -----
    A few frames tell far more than two: see `check_sequence`.
    """
    return check_sequence([frame] if previous is None else [previous, frame])


def check_sequence(frames: Iterable[Frame]) -> Report:
    """Look for what is wrong with consecutive frames of a shot.

    Parameters
    ----------
    frames : iterable of Frame
        In order, without a cut; two are held at a time. Eight of a moving camera are plenty.

    Returns
    -------
    Report

    Raises
    ------
    FrameError
        A field is missing, or of another shape or type than the denoiser takes.
    """
    inspection = Inspection()
    for frame in frames:
        inspection.add(frame)
    return inspection.report()


class Inspection:
    """What all checks say of the frames of a shot, which come one after the other; two are held at a time."""

    def __init__(self) -> None:
        self._sums: dict[Check, Array] = {}
        self._views: list[View] = []
        self._run = self._longest = 0

    def add(self, frame: Frame) -> None:
        """Look at the next frame; raise `FrameError` as `check_sequence`."""
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
        """The next frame does not follow on the last one."""
        self._views, self._run = [], 0

    def report(self) -> Report:
        """What the frames so far say."""
        return judged(self._sums, self._longest)


def judged(sums: dict[Check, Array], count: int) -> Report:
    """What the sums over frames say, of which at most `count` came in a row."""
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
