"""Measures how many errors are within one and within two of the filter's own standard errors.

The frames are those of `svgf-cl compare --no-jitter`. For every pixel that is not a miss, the error of the picture's
luminance is divided by the square root of the sum of two variances: the square of the stage `standard_error`, and the
variance of the truth. The latter is a quarter of the squared difference of the truth's two halves, averaged over 7x7
pixels. If errors had a normal distribution, 68 % would be within 1 and 95 % within 2.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated

import numpy as np
import typer

from benchmarks.command import run
from benchmarks.presentation import markdown
from benchmarks.provenance import provenance
from svgf_cl import Denoiser, Kalman
from svgf_cl.bench.tables import Table
from svgf_cl.cli.console import progress_bar, show
from svgf_cl.cli.options import parse_size
from svgf_cl.compare.footage import Choice, Footage
from svgf_cl.device import devices
from svgf_cl.oracle.taps import Array, luminance, shifted, square
from svgf_cl_tracer import BUILTIN
from svgf_cl_tracer.cli.footage import open_footage

COLUMNS = ("scene", "within 1 %", "within 2 %", "of 68 and 95")


def standard_error(
    scene: Annotated[
        list[str], typer.Argument(metavar="[SCENE]...", help="Built-in scenes, folders with a scene.json, scene files.")
    ] = list(BUILTIN),  # noqa: B006  # never changed; typer wants the default spelled here
    size: Annotated[str, typer.Option(metavar="WxH", help="Size of the frames.")] = "256x144",
    frames: Annotated[int | None, typer.Option(metavar="N", min=2, help="Frames.")] = None,
    spp: Annotated[int, typer.Option(metavar="N", min=2, help="Samples per pixel of the truth.")] = 256,
    markdown_: Annotated[bool, typer.Option("--markdown", help="Print the table as markdown.")] = False,
) -> None:
    """Compare the Kalman filter's own standard error with its error against path-traced truth.

    PYOPENCL_CTX chooses the device. Rendering the truth takes minutes per scene; it is stored in the user's cache.
    """
    rows = []
    choice = Choice(parse_size(size), frames, None, spp, jitter=False)
    for each in [open_footage(name, choice) for name in scene]:
        with progress_bar(each.scene, each.steps + len(each.numbers)) as advance:
            ratios = in_standard_errors(each, advance)
        shares = [100 * float(np.mean(ratios < count)) for count in (1, 2)]
        off = ", ".join(f"{share - normal:+.0f}" for share, normal in zip(shares, (68, 95), strict=True))
        rows.append([each.scene, *(f"{share:.0f}" for share in shares), off])
    table = Table("errors within the standard error", COLUMNS, rows)
    print(markdown(table)) if markdown_ else show(table.title, table.columns, table.rows)
    about = provenance(devices.default_device()) | {"size": size, "truth": f"{spp} spp"}
    print("\n".join(f"{key}: {value}" for key, value in about.items()))


def in_standard_errors(footage: Footage, advance: Callable[[], None]) -> Array:
    """The errors of all hits in the measured frames, divided by their standard deviations: (N,)."""
    halves = footage.truths(advance)
    found = []
    with Denoiser(footage.shape, settings=Kalman(standard_error=True)) as denoiser:
        for number, frame in zip(footage.numbers, footage.frames(), strict=True):
            picture = denoiser.denoise(frame)
            if number in halves:
                first, second = (luminance(half.astype(np.float64)) for half in halves[number])
                error = luminance(picture.astype(np.float64)) - (first + second) / 2
                variance = denoiser.stage("standard_error").astype(np.float64) ** 2 + smooth((first - second) ** 2 / 4)
                hit = np.isfinite(frame.depth) & (variance > 0)
                found.append(np.abs(error[hit]) / np.sqrt(variance[hit]))
            advance()
    return np.concatenate(found)


def smooth(values: Array) -> Array:
    """The mean over the 7x7 pixels around each pixel; (H, W)."""
    taps = [shifted(offset, (values.shape[0], values.shape[1])) for offset in square(3)]
    total: Array = np.mean([values[y, x] for y, x, _ in taps], axis=0)
    return total


def main() -> None:
    """Run the command."""
    run(standard_error, "benchmarks.standard_error")


if __name__ == "__main__":
    main()
