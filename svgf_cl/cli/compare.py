"""``svgf-cl compare``: how far pictures are from their references."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from svgf_cl.cli.console import show, tracked
from svgf_cl.cli.options import Exposure, check_threshold
from svgf_cl.compare.report import COLUMNS, measured, misses, pairs, table_rows


def compare(
    a: Annotated[
        Path,
        typer.Argument(
            metavar="A", help="The picture to judge, or a folder with a sequence of them, such as frame.0000.exr."
        ),
    ],
    b: Annotated[
        Path,
        typer.Argument(
            metavar="B",
            help="Its reference, or a folder of them. If the folder has reference.*.exr, its frame.*.exr are not read.",
        ),
    ],
    min_psnr: Annotated[
        float | None, typer.Option(metavar="DB", help="Least PSNR of any frame.", callback=check_threshold)
    ] = None,
    min_ssim: Annotated[
        float | None, typer.Option(metavar="0..1", help="Least SSIM of any frame.", callback=check_threshold)
    ] = None,
    max_relmse: Annotated[
        float | None, typer.Option(metavar="ERROR", help="Greatest relMSE of any frame.", callback=check_threshold)
    ] = None,
    exposure: Exposure = 0.0,
) -> None:
    """Compare EXR pictures (R, G, B) with their references.

    PSNR and SSIM compare the pictures as they are shown (exposed, clipped to 0..1, in sRGB), relMSE the linear HDR
    values. Frames of two folders are paired by number; every reference needs its picture. Exit code 1 where a frame
    misses a threshold.

    \b
    Examples:
      svgf-cl compare out/demo/denoised out/demo/reference
      svgf-cl compare out/demo/denoised out/demo/reference --min-psnr 30 --min-ssim 0.9
      svgf-cl compare mine.exr truth.exr --exposure 1
    """
    found = pairs(a, b)
    metrics = {name: measured(*pair, exposure) for name, pair in tracked(found.items(), len(found), "comparing")}
    show(f"{a} against {b}", COLUMNS, table_rows(metrics))
    missed = [
        f"{name}: {complaint}" for name, m in metrics.items() for complaint in misses(m, min_psnr, min_ssim, max_relmse)
    ]
    for line in missed:
        typer.echo(line, err=True)
    raise typer.Exit(1 if missed else 0)
