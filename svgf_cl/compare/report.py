"""Pictures and their references: which belong together, how far apart they are, and what of that is too far."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from svgf_cl.compare.metrics import Metrics, mean, measure
from svgf_cl.errors import FileError
from svgf_cl.frame import extent
from svgf_cl.io.atomic import require
from svgf_cl.io.pictures import read_picture
from svgf_cl.io.sequence import find_numbered, frame_number

COLUMNS = ("frame", "PSNR dB", "SSIM", "relMSE")


def pairs(a: Path, b: Path) -> dict[str, tuple[Path, Path]]:
    """Pair each reference with its picture, by what to call the frame; `FileError` where it has none."""
    require(a)
    require(b)
    if a.is_dir() != b.is_dir():
        raise FileError(f"expected two files or two folders, got {a} and {b}")
    if not a.is_dir():
        return {a.name: (a, b)}
    pictures = numbered(a, "frame")
    references = numbered(b, "reference")
    for number, path in references.items():
        if number not in pictures:
            raise FileError(f"{a}: expected a picture number {number} to compare with {path}, found none")
    return {str(number): (pictures[number], path) for number, path in references.items()}


def numbered(folder: Path, stem: str) -> dict[int | None, Path]:
    """Find the pictures of `folder` by number: those called so, or the one sequence it holds."""
    return {frame_number(path): path for path in find_numbered(folder, stem)}


def measured(picture: Path, reference: Path, exposure: float) -> Metrics:
    """Measure one file against another; `FileError` where their sizes differ."""
    tested, truth = read_picture(picture), read_picture(reference)
    if tested.shape != truth.shape:
        sizes = extent(truth.shape[:2]), extent(tested.shape[:2])
        raise FileError(f"{picture}: expected {sizes[0]} pixels as in {reference}, got {sizes[1]}")
    return measure(tested, truth, exposure)


def table_rows(metrics: Mapping[str, Metrics]) -> list[tuple[str, ...]]:
    """Spell the figures of each frame, and their mean, in the order of `COLUMNS`."""
    rows = [*metrics.items(), ("mean", mean(list(metrics.values())))]
    return [(name, f"{m.psnr:.2f}", f"{m.ssim:.4f}", f"{m.relmse:.5f}") for name, m in rows]


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
