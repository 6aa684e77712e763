"""The error that stands beside the tracer's speed: how far a frame of one sample per pixel is from what it shows."""

from __future__ import annotations

from collections.abc import Callable

from svgf_cl.compare.metrics import psnr
from svgf_cl.io.display import display
from svgf_cl_tracer import References, Shot, render_frame


def noise(shot: Shot, number: int, spp: int, advance: Callable[[], None]) -> dict[str, float]:
    """The relMSE to be expected of one sample per pixel, and the frame's PSNR in dB; `spp` samples are the reference.

    All rays go through pixel centres: what differs is noise alone. `advance` is called `chunks(spp)` times.
    """
    references = References(shot, jitter=False)
    estimate = references.render(number, spp, advance)
    frame, truth = render_frame(shot, number, jitter=False).color, references.picture(estimate)
    # The variance of a mean falls with the number of samples: that of a single one is so many times as large.
    return {"relmse": estimate.spp * estimate.error**2, "psnr": psnr(display(frame), display(truth))}
