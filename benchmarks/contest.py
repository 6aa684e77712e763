"""One scene's frames, made into pictures by all rivals by turns, and judged."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, replace

import numpy as np

from benchmarks.footage import Footage
from benchmarks.measurements import paired_medians
from benchmarks.rivals import Rival
from svgf_cl import Denoiser
from svgf_cl.compare.halves import Pair
from svgf_cl.compare.judge import Findings, Judge, switches_in
from svgf_cl.compare.metrics import psnr
from svgf_cl.compare.oidn import OidnFilter
from svgf_cl.compare.view import View
from svgf_cl.io.display import Linear, display

TRUTH = "truth"  # among pictures

Pictures = dict[int, dict[str, Linear]]  # by frame and rival


@dataclass(frozen=True)
class Row:
    """A rival in a scene.

    Parameters
    ----------
    findings : Findings
    call, device : float, optional, ms
        Of a frame: the whole call with numpy arrays in and out, and its passes on an OpenCL device.
    """

    findings: Findings
    call: float | None
    device: float | None


@dataclass(frozen=True)
class Result:
    """A scene with all its rivals.

    Parameters
    ----------
    scene : str
    jitter : bool
    frames : range
        Those judged.
    truth_noise : float, dB
        PSNR of one half of the truth against the other.
    rows : mapping of str to Row
    """

    scene: str
    jitter: bool
    frames: range
    truth_noise: float
    rows: Mapping[str, Row]


def compete(
    footage: Footage, rivals: Mapping[str, Rival], pictured: Collection[int], advance: Callable[[], None]
) -> tuple[Result, Pictures]:
    """Let all rivals, new ones, denoise a footage of one signal and whole pictures, frame by frame.

    Parameters
    ----------
    footage : Footage
    rivals : mapping of str to Rival
    pictured : collection of int
        Judged frames of which the pictures are to be returned, beside the truth.
    advance : callable
        Called ``footage.chunks + footage.frames`` times.
    """
    halves = footage.halves(advance)
    switches = switches_in(halves)
    judges = {name: Judge(switches) for name in rivals}
    pictures: Pictures = {}
    before = None
    for number, split in enumerate(footage.noisy()):
        frame = replace(split, direct=None, indirect=None)
        made = {name: rival.denoise(frame) for name, rival in rivals.items()}
        if number in footage.judged:
            view = View(frame, halves[number - footage.judged.start], footage.jitter, before)
            before = frame, view.halves
            for name, picture in made.items():
                judges[name].see(picture, view)
            if number in pictured:
                pictures[number] = {**made, TRUTH: view.truth}
        advance()
    call, device = times(rivals, footage.judged)
    rows = {name: Row(judge.findings, call.get(name), device.get(name)) for name, judge in judges.items()}
    return Result(footage.scene, footage.jitter, footage.judged, truth_noise(halves), rows), pictures


def times(rivals: Mapping[str, Rival], frames: range) -> tuple[dict[str, float], dict[str, float]]:
    """Milliseconds of a call and on the device, over the judged frames."""
    judged = slice(frames.start, frames.stop)
    call = {name: r.call[judged] for name, r in rivals.items() if isinstance(r.maker, Denoiser | OidnFilter)}
    device = {name: r.device[judged] for name, r in rivals.items() if r.device}
    return steady(call), steady(device)


def steady(samples: Mapping[str, list[float]]) -> dict[str, float]:
    """`paired_medians` by name."""
    return dict(zip(samples, paired_medians(list(samples.values())), strict=True)) if samples else {}


def truth_noise(halves: list[Pair]) -> float:
    """How far the halves of the truth are apart, dB."""
    return float(np.mean([psnr(display(first), display(second)) for first, second in halves]))
