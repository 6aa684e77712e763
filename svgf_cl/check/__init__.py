"""Checks of what a renderer hands over: which of the usual mistakes are in some frames, told from the frames alone.

`check_frame` and `check_sequence` ask every `Check` of `CHECKS` what each frame says; the sums over frames are judged.
"""

from __future__ import annotations

from collections.abc import Iterable

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
    shading.CURVE,
    values.RANGE,
    shading.SHINING,
    values.MISSES,
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
    sums: dict[Check, Array] = {}
    views: list[View] = []
    count = 0
    for frame in frames:
        frame.check(views[-1].frame.shape if views else frame.shape)
        views = [*views[-1:], View.of(frame)]
        count += 1
        for check in CHECKS:
            told = check.ask(views)
            if told is not None:
                sums[check] = sums.get(check, 0) + told
    return judged(sums, count)


def judged(sums: dict[Check, Array], count: int) -> Report:
    """What the sums over `count` frames say."""
    findings: list[Finding] = []
    unknown: list[Unknown] = []
    passed: list[str] = []
    for check in CHECKS:
        wrong = {finding.field for finding in findings if finding.severity == "error"}
        told = check.verdict(sums.get(check), wrong, count)
        findings += [verdict for verdict in told if isinstance(verdict, Finding)]
        unknown += [verdict for verdict in told if isinstance(verdict, Unknown)]
        passed += [] if told else [check.topic]
    return Report(tuple(findings), tuple(unknown), tuple(passed))
