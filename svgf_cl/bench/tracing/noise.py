"""The error that stands beside the tracer's speed: how far a frame is from what it converges to."""

from __future__ import annotations

from collections.abc import Callable

from svgf_cl.display import display
from svgf_cl.metrics import psnr, relmse
from tracer import Shot, render_frame, render_reference


def noise(shot: Shot, number: int, spp: int, advance: Callable[[], None]) -> dict[str, float]:
    """PSNR in dB and relMSE of a frame of one sample per pixel against a reference of `spp` samples.

    All rays go through pixel centres: what differs is noise, the reference's too, which adds 1 / `spp` to the relMSE.
    `advance` is called after each sample.
    """
    noisy = render_frame(shot, number, jitter=False).color
    reference = render_reference(shot, number, spp=spp, jitter=False, progress=lambda *_: advance())
    return {"psnr": psnr(display(noisy), display(reference)), "relmse": relmse(noisy, reference)}
