"""``svgf-cl bench``: how fast the filter is here, and how far from the oracle."""

from __future__ import annotations

from typing import Annotated

import typer

from svgf_cl.bench import Timing, error_to_oracle, measure
from svgf_cl.cli.console import progress_bar, show
from svgf_cl.cli.options import SettingTexts, parse_settings, parse_size
from svgf_cl.denoiser import Denoiser


def bench(
    size: Annotated[list[str], typer.Option(metavar="WxH", help="Size to time; may be repeated.")] = ["1280x720"],  # noqa: B006  # never changed; typer wants the default spelled here
    frames: Annotated[int, typer.Option(metavar="N", min=1, help="Timed frames per size, after warm-up.")] = 40,
    signals: Annotated[
        int, typer.Option(metavar="N", min=1, max=2, help="2: direct and indirect light filtered apart.")
    ] = 1,
    set_: SettingTexts = [],  # noqa: B006
) -> None:
    """Time every pass, and show the error.

    The error is that against the float64 oracle. Input is the camera moving in a built-in room, with albedo and ids.
    Pass times come from OpenCL events; "device" is their sum, "frame" is the whole call with numpy arrays in and out,
    copies included.

    \b
    Examples:
      svgf-cl bench
      svgf-cl bench --size 1280x720 --size 1920x1080 --signals 2 --set taa=on
    """
    settings = parse_settings(set_)
    shapes = [parse_size(text) for text in size]
    for shape in shapes:
        den = Denoiser(shape, settings=settings)
        with progress_bar(f"{shape[1]}x{shape[0]}", frames) as advance:
            timings = measure(den, frames, signals=signals, advance=advance)
        megapixels = shape[0] * shape[1] / 1e6
        columns = ("pass", "median ms", "10 %", "90 %", "Mpixel/s")
        rows = [timing_row(timing, megapixels) for timing in timings]
        show(f"{shape[1]}x{shape[0]}, {frames} frames, {den.nbytes / 2**20:.0f} MiB of planes", columns, rows)
    device = den.queue.device
    worst, rms = error_to_oracle(settings, signals=signals)
    print(f"device: {device.name} ({device.platform.version})")
    print(f"error against the float64 oracle, relative to the picture's mean: rms {rms:.1e}, largest {worst:.1e}")


def timing_row(timing: Timing, megapixels: float) -> tuple[str, ...]:
    """Spell one row of the table."""
    times = (f"{value:.2f}" for value in (timing.median, timing.low, timing.high))
    return (timing.name, *times, f"{1e3 * megapixels / timing.median:.0f}")
