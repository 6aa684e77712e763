"""``svgf-cl compare``: how far pictures are from their references."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from svgf_cl.cli.console import show, tracked
from svgf_cl.cli.options import Exposure, check_threshold
from svgf_cl.compare.metrics import Metrics, mean, measure
from svgf_cl.errors import SequenceError
from svgf_cl.frame import extent
from svgf_cl.io.atomic import require
from svgf_cl.io.frames import find_numbered, frame_number, read_picture


def compare(
    a: Annotated[
        Path, typer.Argument(metavar="A", help="The picture to judge, or a folder of frame.0000.exr and so on.")
    ],
    b: Annotated[
        Path, typer.Argument(metavar="B", help="Its reference, or a folder; in it reference.* count before frame.*.")
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

    PSNR and SSIM are taken as shown (exposed, clipped to 0..1, sRGB), relMSE on linear HDR. Frames of two folders are
    paired by number; every reference needs its picture. Exit code 1 where a frame misses a threshold.

    \b
    Examples:
      svgf-cl compare out/demo/denoised out/demo/reference
      svgf-cl compare out/demo/denoised out/demo/reference --min-psnr 30 --min-ssim 0.9
      svgf-cl compare mine.exr truth.exr --exposure 1
    """
    found = pairs(a, b)
    metrics = {name: measured(*pair, exposure) for name, pair in tracked(found.items(), len(found), "comparing")}
    rows = [*metrics.items(), ("mean", mean(list(metrics.values())))]
    show(
        f"{a} against {b}",
        ("frame", "PSNR dB", "SSIM", "relMSE"),
        [(name, f"{m.psnr:.2f}", f"{m.ssim:.4f}", f"{m.relmse:.5f}") for name, m in rows],
    )
    missed = [
        f"{name}: {complaint}" for name, m in metrics.items() for complaint in misses(m, min_psnr, min_ssim, max_relmse)
    ]
    for line in missed:
        typer.echo(line, err=True)
    raise typer.Exit(1 if missed else 0)


def pairs(a: Path, b: Path) -> dict[str, tuple[Path, Path]]:
    """Pair each reference with its picture, by what to call the frame; `SequenceError` where it has none."""
    require(a)
    require(b)
    if a.is_dir() != b.is_dir():
        raise SequenceError(f"expected two files or two folders, got {a} and {b}")
    if not a.is_dir():
        return {a.name: (a, b)}
    pictures = numbered(a, "frame", "reference")
    references = numbered(b, "reference", "frame")
    for number, path in references.items():
        if number not in pictures:
            raise SequenceError(f"{a}: expected a picture number {number} to compare with {path}, found none")
    return {str(number): (pictures[number], path) for number, path in references.items()}


def numbered(folder: Path, *stems: str) -> dict[int | None, Path]:
    """Find the pictures of `folder` by number, of the first of `stems` that has any."""
    for stem in stems:
        if files := find_numbered(folder, stem):
            return {frame_number(path): path for path in files}
    raise SequenceError(f"{folder}: expected files named {stems[0]}.0000.exr in this folder, found none")


def measured(picture: Path, reference: Path, exposure: float) -> Metrics:
    """Measure one file against another; `SequenceError` where their sizes differ."""
    tested, truth = read_picture(picture), read_picture(reference)
    if tested.shape != truth.shape:
        sizes = extent(truth.shape[:2]), extent(tested.shape[:2])
        raise SequenceError(f"{picture}: expected {sizes[0]} pixels as in {reference}, got {sizes[1]}")
    return measure(tested, truth, exposure)


def misses(found: Metrics, min_psnr: float | None, min_ssim: float | None, max_relmse: float | None) -> list[str]:
    """Say what of `found` is beyond a threshold; NaN is beyond all."""
    complaints = []
    if min_psnr is not None and not found.psnr >= min_psnr:
        complaints.append(f"PSNR {found.psnr:.2f} dB is below {min_psnr:g} dB")
    if min_ssim is not None and not found.ssim >= min_ssim:
        complaints.append(f"SSIM {found.ssim:.4f} is below {min_ssim:g}")
    if max_relmse is not None and not found.relmse <= max_relmse:
        complaints.append(f"relMSE {found.relmse:.5f} is above {max_relmse:g}")
    return complaints
