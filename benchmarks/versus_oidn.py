"""svgf_cl against Open Image Denoise: the same frames, the same threads, one interleaved run; speed, memory and error.

Speed: in every round each denoiser filters the same frame of the built-in room once, after a warm-up.

- "svgf_cl, whole call": `Denoiser.denoise` from numpy arrays into a numpy array, all copies included.
- "svgf_cl, device": the passes of that same call, from OpenCL events.
- "OIDN ...": ``oidnExecuteFilter`` alone, HDR, with albedo and normal, in place on images that were filled before.

A ratio is that of two times of one round; what counts is its median over the rounds. Memory is what a denoiser holds
beside the images that go in and come out: `Denoiser.nbytes`, and what the process grew by while OIDN was set up and ran
once.

Error: that of one footage of `benchmarks.footage` at the same size, rays jittered, against the path-traced truth. OIDN
sees one frame; svgf_cl knows those before it.
"""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Callable, Mapping
from dataclasses import asdict, replace
from pathlib import Path
from typing import Annotated

import pyopencl as cl
import typer

from benchmarks.footage import FOOTAGE, Footage
from benchmarks.measurements import Quality, quality
from benchmarks.oidn import QUALITIES, Filter
from benchmarks.provenance import provenance
from benchmarks.race import WHOLE, race
from benchmarks.versus_tables import bar_table, error_table, ratio_table, time_table
from svgf_cl import Denoiser
from svgf_cl.cli.console import progress_bar, show
from svgf_cl.cli.options import SettingTexts, parse_settings, parse_size
from svgf_cl.display import Linear
from svgf_cl.errors import SvgfError
from svgf_cl.files import written_whole
from svgf_cl.frame import Shape
from svgf_cl.metrics import require_flip

AREA, _ = FOOTAGE


def versus_oidn(
    size: Annotated[str, typer.Option(metavar="WxH", help="Size of the frames.")] = "1280x720",
    rounds: Annotated[int, typer.Option(metavar="N", min=1, help="Timed frames of each denoiser.")] = 20,
    clean_aux: Annotated[
        bool, typer.Option("--clean-aux", help="Tell OIDN that albedo and normal are free of noise.")
    ] = False,
    set_: SettingTexts = [],  # noqa: B006  # never changed; typer wants the default spelled here
    json_: Annotated[Path | None, typer.Option("--json", metavar="FILE", help="Write all samples there, too.")] = None,
    markdown: Annotated[bool, typer.Option("--markdown", help="Print tables as markdown.")] = False,
) -> None:
    """Time svgf_cl and Open Image Denoise by turns, hold the ratios against the bars, and compare their errors.

    PYOPENCL_CTX chooses svgf_cl's device. OIDN gets as many CPU threads as that device has, or all where it is no CPU.
    The truth takes a minute or two to render the first time, and is kept in the user's cache folder.
    """
    require_flip()
    shape, settings = parse_size(size), parse_settings(set_)
    den = Denoiser(shape, settings=settings)
    filters = oidn_filters(shape, den.queue.device, clean_aux)
    with progress_bar("speed", rounds) as advance:
        times = race(den, filters, rounds, advance)
    memory = {WHOLE: den.nbytes} | {name: rival.nbytes for name, rival in filters.items()}
    footage = replace(AREA, shape=shape)
    with progress_bar("error", footage.parts_to_render + footage.frames) as advance:
        errors = qualities(den, filters, footage, advance)
    tables = (time_table(times, memory), ratio_table(times), bar_table(times), error_table(errors))
    about = provenance(den.queue.device) | {
        "oidn": filters["OIDN high"].description,
        "size": size,
        "rounds": str(rounds),
        "truth": f"{footage.spp} spp",
    }
    for table in tables:
        print(table.markdown()) if markdown else show(*table)
    print("\n".join(f"{key}: {value}" for key, value in about.items()))
    if json_:
        record = about | {"settings": vars(settings), "clean aux": clean_aux, "milliseconds": times, "bytes": memory}
        record |= {"bars": bar_table(times).rows, "error": {name: asdict(found) for name, found in errors.items()}}
        with written_whole(json_) as aside:
            aside.write_text(json.dumps(record, indent=1), encoding="utf-8")


def oidn_filters(shape: Shape, device: cl.Device, clean_aux: bool) -> dict[str, Filter]:
    """OIDN at every quality, with as many threads as a CPU device has; with all where `device` is no CPU."""
    is_cpu = bool(device.type & cl.device_type.CPU)
    threads = device.max_compute_units if is_cpu else os.cpu_count() or 1
    return {f"OIDN {quality}": Filter(shape, quality, threads, clean_aux=clean_aux) for quality in QUALITIES}


def qualities(
    den: Denoiser, filters: Mapping[str, Filter], footage: Footage, advance: Callable[[], None]
) -> dict[str, Quality]:
    """Hold what every denoiser makes of a footage, one signal, against the truth about it; the noise itself, too."""
    truth = [0.5 * (first + second) for first, second in footage.halves(advance)]
    pictures: dict[str, list[Linear]] = {name: [] for name in ("noisy", "svgf_cl", *filters)}
    den.reset()
    for number, split in enumerate(footage.noisy()):
        frame = replace(split, direct=None, indirect=None)
        clean = den.denoise(frame)
        if number in footage.judged:
            alone = {name: rival.denoise(frame) for name, rival in filters.items()}
            for name, picture in {"noisy": frame.color, "svgf_cl": clean, **alone}.items():
                pictures[name].append(picture[slice(*footage.rows)])
        advance()
    return {name: quality(made, truth) for name, made in pictures.items()}


def main() -> None:
    """Run the command; wrong input ends in one line, as that of ``svgf-cl`` does."""
    try:
        typer.run(versus_oidn)
    except SvgfError as error:
        print(f"versus_oidn: {error}", file=sys.stderr)
        sys.exit(2)


if __name__ == "__main__":
    main()
