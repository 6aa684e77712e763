"""Speed against error: what every choice that trades one for the other costs and brings, in one table and one plot.

Time: milliseconds a frame of the closed-form room on the default device, medians over turns taken by all variants.

Error, two kinds:

- against the float64 oracle *that does the same* (levels, taps, antialiasing alike): what arithmetic and storage lose.
  Root mean square over a short sequence of the room, relative to the picture's mean.
- against path-traced truth, in a band of rows of the last two of 24 frames of a camera moving through a scene at 1
  sample per pixel, of the size that is timed. "area": jittered rays, truth averaged over the pixel's area, as a
  renderer is used; without TAA much of the error is aliasing of edges, which no filter of light can remove. "centre":
  all rays through pixel centres, the truth's too: the filter's own error, without TAA, which needs jitter.

How the metrics are defined: `svgf_cl.metrics`. The truth has noise of its own, given below the table.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import Annotated, Any

import typer

from benchmarks.footage import FOOTAGE, PART
from benchmarks.measurements import Quality, Result, measure, steps
from benchmarks.presentation import MARK, markdown, oracle_column, plot, quality_columns, table
from benchmarks.provenance import provenance
from benchmarks.variants import VARIANTS
from svgf_cl import devices
from svgf_cl.cli.console import progress_bar, show
from svgf_cl.cli.options import parse_rgb, parse_size
from svgf_cl.cli.render import CAMERA_HELP, SKY_HELP
from svgf_cl.errors import SvgfError
from svgf_cl.files import make_folder, written_whole
from svgf_cl.metrics import require_flip
from tracer import Camera


def speed_against_error(
    output: Annotated[
        Path, typer.Option("-o", "--output", metavar="DIR", help="Gets results.json, table.md and plot.png.")
    ] = Path("out/speed-against-error"),
    size: Annotated[str, typer.Option(metavar="WxH", help="Size of the frames.")] = "1280x720",
    rounds: Annotated[int, typer.Option(metavar="N", min=1, help="Turns of each variant, two timed frames each.")] = 12,
    scene: Annotated[
        str, typer.Option(metavar="SCENE", help="A glTF, GLB or OBJ file, or the name of a built-in scene.")
    ] = "cornell",
    camera: Annotated[list[str], typer.Option(metavar="TEXT", help=CAMERA_HELP)] = [],  # noqa: B006  # never changed
    sky: Annotated[str | None, typer.Option(metavar="R,G,B", help=SKY_HELP)] = None,
    spp: Annotated[
        int, typer.Option(metavar="N", min=2 * PART, help=f"Samples per pixel of the truth, a multiple of {2 * PART}.")
    ] = 512,
) -> None:
    """Measure time, error against the oracle and error against path-traced truth of every variant.

    The truth takes some minutes to render the first time, and is kept in the user's cache folder.
    """
    require_flip()
    if spp % (2 * PART):
        raise typer.BadParameter(f"expected a multiple of {2 * PART}, got {spp}", param_hint="--spp")
    shape = parse_size(size)
    place: dict[str, Any] = {"scene": scene, "cameras": tuple(Camera.parse(text) for text in camera)}
    place["sky"] = parse_rgb(sky) if sky else None
    footages = [replace(footage, shape=shape, spp=spp, **place) for footage in FOOTAGE]
    folder = make_folder(output)
    with progress_bar("speed against error", steps(VARIANTS, footages, rounds)) as advance:
        results, noise = measure(VARIANTS, footages, shape, rounds, advance)
    about = provenance(devices.default_device()) | {"size": size, "truth": f"{scene}, {spp} spp"}
    write(folder, results, noise, about)
    print(f"{MARK}: on the Pareto front of device time and that error")
    show("error against the oracle", *table(results, [oracle_column()]))
    for name, halves in noise.items():
        show(f"error against the truth, {name}", *table(results, quality_columns(name)))
        print(noise_line(name, halves))
    print("\n".join(f"{key}: {value}" for key, value in about.items()))
    print(f"table, plot and JSON: {folder}")


def noise_line(name: str, halves: Quality) -> str:
    """How far the truth's two halves are apart; the truth, their mean, is 6 dB closer to what they converge to."""
    return (
        f"noise of the truth, {name}: its halves differ by PSNR {halves.psnr:.1f} dB, relMSE {halves.relmse:.4f}, "
        f"FLIP {halves.flip:.4f}, temporal {halves.temporal:.4f}"
    )


def write(folder: Path, results: Sequence[Result], noise: dict[str, Quality], about: dict[str, str]) -> None:
    """Write JSON, markdown and plot."""
    record: dict[str, Any] = {**about, "noise": {k: asdict(q) for k, q in noise.items()}}
    record["results"] = [asdict(result) for result in results]
    with written_whole(folder / "results.json") as aside:
        aside.write_text(json.dumps(record, indent=1), encoding="utf-8")
    with written_whole(folder / "table.md") as aside:
        aside.write_text(page(results, noise, about), encoding="utf-8")
    plot(results, noise, f"Speed against error, {about['size']}, {devices.default_device().name}", folder / "plot.png")


def page(results: Sequence[Result], noise: dict[str, Quality], about: dict[str, str]) -> str:
    """The one table, and what has to be known about it, in markdown."""
    columns = [oracle_column(), *(column for name in noise for column in quality_columns(name))]
    remarks = [*(noise_line(*pair) for pair in noise.items()), *(f"{key}: {value}" for key, value in about.items())]
    return markdown(*table(results, columns)) + "\n" + "".join(f"- {remark}\n" for remark in remarks)


def main() -> None:
    """Run the command; wrong input ends in one line, as that of ``svgf-cl`` does."""
    try:
        typer.run(speed_against_error)
    except SvgfError as error:
        print(f"speed_against_error: {error}", file=sys.stderr)
        sys.exit(2)


if __name__ == "__main__":
    main()
