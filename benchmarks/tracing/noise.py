"""The error of a frame with one sample per pixel, which is shown beside the tracer's speed."""

from __future__ import annotations

from collections.abc import Callable

from svgf_cl.compare.metrics import psnr
from svgf_cl.io.display import display
from svgf_cl_tracer import References, Shot, render_frame


def noise(shot: Shot, number: int, spp: int, advance: Callable[[], None]) -> dict[str, float]:
    """The expected relMSE of one sample per pixel, and the frame's PSNR in dB; the reference has `spp` samples.

    All rays go through pixel centres, so that all differences are noise. `advance` is called `chunks(spp)` times.
    """
    references = References(shot, jitter=False)
    estimate = references.render(number, spp, advance)
    frame, truth = render_frame(shot, number, jitter=False).color, references.picture(estimate)
    # The variance of a mean is that of a sample divided by the number of samples.
    return {"relmse": estimate.spp * estimate.error**2, "psnr": psnr(display(frame), display(truth))}
