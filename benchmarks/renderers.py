"""Compares frames of renderers before and after ``svgf-cl denoise`` without options with references.

Each folder has noisy frames in ``noisy``, and references with the same numbers in ``reference``; frames without a
reference are filtered, but not measured. There is only one reference per frame, so its own noise counts as error. The
view layer is that of the reference. `scripts/renderers` renders such folders.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from benchmarks.command import run
from benchmarks.presentation import markdown
from benchmarks.provenance import provenance
from svgf_cl.bench.tables import Table
from svgf_cl.cli.console import progress_bar, show
from svgf_cl.compare.judge import Findings, Judge
from svgf_cl.compare.measures import MEASURES, value
from svgf_cl.compare.recorded import bare_frame, by_number, check_size
from svgf_cl.compare.tables import spelled
from svgf_cl.compare.view import View
from svgf_cl.device import devices
from svgf_cl.errors import FileError
from svgf_cl.filters import DEFAULT
from svgf_cl.io.atomic import require
from svgf_cl.io.display import Linear
from svgf_cl.io.exr import read_image
from svgf_cl.io.image import Image
from svgf_cl.io.reading import ReadAs, Reading, stacked
from svgf_cl.io.sequence import find_frames, number_of
from svgf_cl.io.shot import Shot
from svgf_cl.io.window import placed
from svgf_cl.job import made_forward
from svgf_cl.shot_denoiser import Method

SHOWN = ("psnr", "ssim", "flip", "temporal")
COLUMNS = [each for each in MEASURES if each.key in SHOWN]


@dataclass(frozen=True)
class Gain:
    """The quality of a folder's pictures, before and after."""

    folder: Path
    before: Findings
    after: Findings

    @property
    def worse(self) -> list[str]:
        """The measures in which pictures became worse."""
        return [
            each.title
            for each in COLUMNS
            if each.merit(value(self.after, each.key)) < each.merit(value(self.before, each.key))
        ]

    @property
    def spelled(self) -> list[str]:
        """The row of the table."""
        pairs = [(each, value(self.before, each.key), value(self.after, each.key)) for each in COLUMNS]
        figures = [f"{spelled(each, before)} → {spelled(each, after)}" for each, before, after in pairs]
        return ["/".join(self.folder.resolve().parts[-2:]), *figures]


@dataclass
class Judged:
    """The measures of a folder, frame by frame."""

    before: Judge = field(default_factory=Judge)
    after: Judge = field(default_factory=Judge)
    earlier: tuple[int, View] | None = None

    def see(self, number: int, pictures: tuple[Linear, Linear], truth: Linear) -> None:
        """Measure a frame by its number: its pictures before and after, and its reference."""
        frame, halves, earlier = bare_frame(pictures[0]), (truth, truth), None
        if self.earlier and self.earlier[0] == number - 1:
            earlier = self.earlier[1].frame, self.earlier[1].halves
        view = View(frame, halves, jitter=False, earlier=earlier)
        for judge, picture in zip((self.before, self.after), pictures, strict=True):
            judge.see(picture, view)
        self.earlier = number, view


def measured(
    folder: Annotated[list[Path], typer.Argument(help="Folders with noisy/ and reference/.")],
    markdown_: Annotated[bool, typer.Option("--markdown", help="Print the table as markdown.")] = False,
) -> None:
    """Measure the gain of `svgf-cl denoise` without options on frames of renderers.

    The exit code is 1 if any measure became worse. PYOPENCL_CTX chooses the device.
    """
    gains = []
    with progress_bar("denoising", len(folder)) as advance:
        for each in folder:
            gains.append(gain(each))
            advance()
    heads = ("folder", *(f"{each.name} {each.arrow}" for each in COLUMNS))
    table = Table("before and after", heads, [each.spelled for each in gains])
    print(markdown(table)) if markdown_ else show(table.title, table.columns, table.rows)
    print("\n".join(f"{key}: {text}" for key, text in provenance(devices.default_device()).items()))
    worse = {each.folder: each.worse for each in gains if each.worse}
    for each, measures in worse.items():
        print(f"worse than before: {each}: {', '.join(measures)}")
    raise typer.Exit(bool(worse))


def gain(folder: Path) -> Gain:
    """Denoise the frames of a folder, and measure those that have a reference.

    Raises
    ------
    FileError
        If a folder or file is missing or cannot be read, if no frame has a reference, or if sizes differ.
    """
    frames, references = folder / "noisy", folder / "reference"
    require(frames)
    require(references)
    truths, paths, judged = by_number(references, "reference"), find_frames([frames]), Judged()
    if not truths.keys() & {number_of(path) for path in paths}:
        raise FileError(f"{references}: expected the number of a frame in {frames}, found none")
    _, layer = reference(next(iter(truths.values())))
    for path, before, after in pictures(paths, ReadAs(view_layer=layer or None)):
        if (number := number_of(path)) in truths:
            truth, _ = reference(truths[number])
            check_size(path, after.shape[:2], truth.shape[:2])
            judged.see(number, (before, after), truth)
    return Gain(folder, judged.before.findings, judged.after.findings)


def pictures(paths: Sequence[Path], how: ReadAs) -> Iterator[tuple[Path, Linear, Linear]]:
    """The pictures of each frame before and after, in the display window."""
    shot = Shot(paths, how)
    for index, made in made_forward(shot, Method(DEFAULT()), range(len(shot)), look=None):
        image = made.source.image
        after = placed(made.denoised.picture, shot.window, image.windows.display, 0.0)
        yield paths[index], shown(paths[index], image, shot.reading), after


def reference(path: Path) -> tuple[Linear, str]:
    """The picture of a reference, and its view layer."""
    image = read_image(path)
    reading = Reading(path, image, ReadAs())
    return shown(path, image, reading), reading.view_layer


def shown(path: Path, image: Image, reading: Reading) -> Linear:
    """The picture of a file in its display window; values that are not finite become black."""
    picture = stacked(path, image.planes, reading.picture)
    return placed(
        np.where(np.isfinite(picture), picture, np.float32(0)), image.windows.data, image.windows.display, 0.0
    )


def main() -> None:
    """Run the command."""
    run(measured, "benchmarks.renderers")


if __name__ == "__main__":
    main()
