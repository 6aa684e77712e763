"""Speed against error: time and errors of every setting that trades one for the other, as a table and a plot.

Time: milliseconds per frame of the built-in room on the default device. The variants are timed in turns. The time of a
variant is the median of the default's time, multiplied by the median of the ratio of both times of a turn.

Error, of two kinds:

- compared with the float64 oracle *with the same settings* (levels, taps, antialiasing): the loss by arithmetic and
  storage. It is the root mean square over a short sequence of the room, relative to the picture's mean.
- compared with the path-traced truth, in a band of rows of the last two of 24 frames. A camera moves through a scene at
  1 sample per pixel, at the size that is timed. "area": rays are jittered, and the truth is the mean over the pixel's
  area, as usual in rendering; without TAA much of the error is aliasing of edges, which no filter of light can remove.
  "centre": all rays, including those of the truth, go through pixel centres; this is the filter's own error, without
  TAA, which needs jitter.

`svgf_cl.compare.metrics` defines the metrics. The truth has noise, which is listed below the table.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any

import typer

from benchmarks.command import run
from benchmarks.findings import TITLE, Findings
from benchmarks.footage import FOOTAGE, Footage
from benchmarks.measurements import measure, steps
from benchmarks.provenance import provenance
from benchmarks.variants import VARIANTS
from svgf_cl.cli.console import progress_bar, show
from svgf_cl.cli.options import parse_size
from svgf_cl.compare.metrics import require_flip
from svgf_cl.device import devices
from svgf_cl.frame import extent
from svgf_cl.io.atomic import output_folder
from svgf_cl_tracer import Camera
from svgf_cl_tracer.cli.render import CAMERA_HELP
from svgf_cl_tracer.cli.scenes import parse_rgb
from svgf_cl_tracer.references import CHUNK


def speed_against_error(
    output: Annotated[
        Path, typer.Option("-o", "--output", metavar="DIR", help="Gets results.json, table.md and plot.png.")
    ] = Path("out/speed-against-error"),
    size: Annotated[str, typer.Option(metavar="WxH", help="Size of the frames.")] = "1280x720",
    rounds: Annotated[int, typer.Option(metavar="N", min=1, help="Turns of each variant, two timed frames each.")] = 20,
    scene: Annotated[
        str, typer.Option(metavar="SCENE", help="A glTF, GLB or OBJ file, or the name of a built-in scene.")
    ] = "cornell",
    camera: Annotated[list[str], typer.Option(metavar="TEXT", help=CAMERA_HELP)] = [],  # noqa: B006  # never changed
    sky: Annotated[
        str | None, typer.Option(metavar="R,G,B", help="Light outside: linear radiance, as 0.4,0.5,0.7.")
    ] = None,
    spp: Annotated[
        int,
        typer.Option(metavar="N", min=2 * CHUNK, help=f"Samples per pixel of the truth, a multiple of {2 * CHUNK}."),
    ] = 512,
) -> None:
    """Measure time, error against the oracle and error against path-traced truth of every variant.

    Rendering the truth takes some minutes; it is stored in the user's cache folder.
    """
    require_flip()
    if spp % (2 * CHUNK):
        raise typer.BadParameter(f"expected a multiple of {2 * CHUNK}, got {spp}", param_hint="--spp")
    shape = parse_size(size)
    place: dict[str, Any] = {"scene": scene, "cameras": tuple(Camera.parse(text) for text in camera)}
    place["sky"] = parse_rgb(sky) if sky else None
    footages = [replace(footage, shape=shape, spp=spp, **place) for footage in FOOTAGE]
    folder = output_folder(output)
    findings = found(footages, rounds)
    findings.write(folder)
    for part in findings.tables:
        show(part.title, part.columns, part.rows)
    print("\n".join([*findings.remarks, f"{folder}: results.json, table.md, plot.png"]))


def found(footages: Sequence[Footage], rounds: int) -> Findings:
    """Measure every variant on the default device, with footages of one scene and one size."""
    film = footages[0]
    about = {"size": extent(film.shape), "truth": f"{film.scene}, {film.spp} spp"}
    with progress_bar(TITLE.lower(), steps(VARIANTS, footages, rounds)) as advance:
        measured = measure(VARIANTS, footages, film.shape, rounds, advance)
    return Findings(*measured, provenance(devices.default_device()) | about)


def main() -> None:
    """Run the command."""
    run(speed_against_error, "benchmarks.speed_against_error")


if __name__ == "__main__":
    main()
