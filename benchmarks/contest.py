"""One scene's frames, made into pictures by all rivals by turns, and judged."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from benchmarks.footage import Footage
from benchmarks.judge import Findings, Judge, View, switches_in
from benchmarks.measurements import paired_medians
from benchmarks.oidn import OidnFilter
from benchmarks.rivals import Rival
from svgf_cl import Denoiser
from svgf_cl.compare.halves import Pair
from svgf_cl.compare.metrics import psnr
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

    @property
    def record(self) -> dict[str, Any]:
        """What a JSON file holds of it."""
        frames = [self.frames.start, self.frames.stop]
        rows = {
            name: asdict(row.findings) | {"call": row.call, "device": row.device} for name, row in self.rows.items()
        }
        about = {"scene": self.scene, "jitter": self.jitter, "frames": frames, "truth_noise": self.truth_noise}
        return {**about, "rows": rows}


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
    """Milliseconds of a call and on the device, over the judged frames, steady where the machine is not."""
    timed = slice(frames.start, frames.stop)
    call = {name: r.call[timed] for name, r in rivals.items() if isinstance(r.maker, Denoiser | OidnFilter)}
    device = {name: r.device[timed] for name, r in rivals.items() if r.device}
    medians = (paired_medians(list(each.values())) for each in (call, device))
    of_call, of_device = (
        dict(zip(each, found, strict=True)) for each, found in zip((call, device), medians, strict=True)
    )
    return of_call, of_device


def truth_noise(halves: list[Pair]) -> float:
    """How far the halves of the truth are apart, dB."""
    return float(np.mean([psnr(display(first), display(second)) for first, second in halves]))
