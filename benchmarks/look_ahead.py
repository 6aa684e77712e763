"""Measures the gain of looking ahead: the filter forward, backward, and both averaged, beside Open Image Denoise.

Every frame of a scene is measured, including the first and the last, where one of the runs has little history. The
frames and measures are those of `svgf-cl compare --no-jitter`. Times are of whole calls for a frame, on the host, as
the mean over the frames; kernels are built beforehand.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from benchmarks.command import run
from benchmarks.presentation import markdown
from benchmarks.provenance import provenance
from svgf_cl import Denoiser, Frame, look_ahead, motion_to_next
from svgf_cl.bench.tables import Table
from svgf_cl.cli.console import progress_bar, show
from svgf_cl.cli.options import parse_size
from svgf_cl.compare.footage import Choice, Footage
from svgf_cl.compare.halves import Pair
from svgf_cl.compare.judge import Findings, Judge
from svgf_cl.compare.measures import MEASURES, value
from svgf_cl.compare.oidn import require_oidn
from svgf_cl.compare.rivals import FrameByFrame
from svgf_cl.compare.tables import spelled
from svgf_cl.compare.view import View
from svgf_cl.device import devices
from svgf_cl.frame import Shape
from svgf_cl.io.atomic import output_folder
from svgf_cl.io.display import Linear, to_bytes, write_image
from svgf_cl_tracer.cli.footage import open_footage

SCENES = ("cornell", "swing", "switch", "glossy")
AHEAD = (2, 4, 8)
SHOWN = ("psnr", "ssim", "flip", "temporal", "shadows", "moving_shadows", "ghost")
COLUMNS = [each for each in MEASURES if each.key in SHOWN]
Pictures = Callable[[Sequence[Frame]], Iterable[Linear]]


@dataclass(frozen=True)
class Row:
    """One way to make a scene's pictures: its quality, and the time of a frame in ms."""

    scene: str
    way: str
    findings: Findings
    milliseconds: float

    @property
    def spelled(self) -> list[str]:
        """The row of the table."""
        figures = [spelled(each, value(self.findings, each.key)) for each in COLUMNS]
        return [self.scene, self.way, *figures, f"{self.milliseconds:.0f}"]


def measured(
    scene: Annotated[
        list[str], typer.Argument(metavar="[SCENE]...", help="Built-in scenes, folders with a scene.json, scene files.")
    ] = list(SCENES),  # noqa: B006  # never changed; typer wants the default spelled here
    size: Annotated[str, typer.Option(metavar="WxH", help="Size of the frames.")] = "320x180",
    frames: Annotated[int, typer.Option(metavar="N", min=2, help="Frames.")] = 16,
    spp: Annotated[int, typer.Option(metavar="N", min=2, help="Samples per pixel of the truth.")] = 128,
    markdown_: Annotated[bool, typer.Option("--markdown", help="Print the table as markdown.")] = False,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="DIR", help="Gets the pictures of the middle frame as PNG.")
    ] = None,
) -> None:
    """Measure the gain of looking ahead over the forward run alone, and over Open Image Denoise frame by frame.

    PYOPENCL_CTX chooses the device. Rendering the truth takes minutes per scene; it is stored in the user's cache.
    """
    require_oidn()
    shape = parse_size(size)
    rows: list[Row] = []
    for name in scene:
        footage = open_footage(name, Choice(shape, frames, frames, spp, jitter=False))
        with progress_bar(footage.name, footage.steps + len(ways(shape))) as advance:
            rows.extend(judged(footage, advance, output and output_folder(output)))
    heads = ("scene", "", *(f"{each.name} {each.arrow}" for each in COLUMNS), "ms a frame")
    table = Table("looking ahead", heads, [row.spelled for row in rows])
    print(markdown(table)) if markdown_ else show(table.title, table.columns, table.rows)
    about = provenance(devices.default_device()) | {"size": size, "frames": str(frames), "truth": f"{spp} spp"}
    print("\n".join(f"{key}: {value}" for key, value in about.items()))


def judged(footage: Footage, advance: Callable[[], None], output: Path | None) -> Iterator[Row]:
    """A row for each way to make a scene's pictures; the pictures of the middle frame are written to `output`."""
    truths = footage.truths(advance)
    frames = list(footage.frames())
    middle = footage.numbers[len(frames) // 2]
    if output:
        save(output, footage.name, "truth", np.mean(truths[middle], axis=0))
    for way, make in ways(footage.shape).items():
        list(make(frames[:3]))  # builds the kernels
        begin = time.perf_counter()
        pictures = list(make(frames))
        elapsed = time.perf_counter() - begin
        if output:
            save(output, footage.name, way, pictures[middle])
        yield Row(footage.name, way, found(pictures, frames, truths), 1e3 * elapsed / len(frames))
        advance()


def found(pictures: Sequence[Linear], frames: Sequence[Frame], truths: Mapping[int, Pair]) -> Findings:
    """The quality of the pictures of all frames."""
    judge = Judge()
    seen = [(frame, truths[number]) for number, frame in enumerate(frames)]
    for picture, (frame, halves), earlier in zip(pictures, seen, [None, *seen], strict=False):
        judge.see(picture, View(frame, halves, jitter=False, earlier=earlier))
    return judge.findings


def ways(shape: Shape) -> dict[str, Pictures]:
    """The ways to make pictures, by name."""
    forward, backward, rival = Denoiser(shape), Denoiser(shape), FrameByFrame(shape)

    def ahead(count: int | None) -> Pictures:
        return lambda frames: look_ahead(frames, forward, backward, ahead=count)

    return {
        "forward": lambda frames: filtered(forward, frames),
        "backward": lambda frames: [*filtered(backward, turned_round(frames))][::-1],
        **{f"both, {count} ahead": ahead(count) for count in AHEAD},
        "both, whole shot": ahead(None),
        "Open Image Denoise": lambda frames: map(rival.denoise, frames),
    }


def filtered(denoiser: Denoiser, frames: Iterable[Frame]) -> Iterator[Linear]:
    """The pictures of one run."""
    denoiser.reset()
    return map(denoiser.denoise, frames)


def turned_round(frames: Sequence[Frame]) -> Iterator[Frame]:
    """The same frames, backward in time."""
    yield frames[-1]
    for later, frame in pairwise(reversed(frames)):
        yield replace(frame, motion=motion_to_next(frame, later))


def save(folder: Path, scene: str, way: str, picture: Linear) -> None:
    """Write a picture as ``swing.forward.png``."""
    write_image(folder / f"{scene}.{way.replace(', ', '-').replace(' ', '-')}.png", to_bytes(picture))


def main() -> None:
    """Run the command."""
    run(measured, "benchmarks.look_ahead")


if __name__ == "__main__":
    main()
