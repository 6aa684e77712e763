"""Measures the join between two chunks of a shot that were denoised separately, by the length of the warm-up.

For each scene, one long shot is denoised as a whole. Its last frame, at which a chunk would begin, is also denoised
after warm-ups of different lengths. Three things are measured in that last frame: its difference from the frame of the
whole shot; that difference as a share of the change from the previous frame, both rms as shown; and the error of both
compared with the path-traced truth. A join is an additional change of the picture. If it is a small part of the change
that happens anyway, nobody sees it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Annotated

import numpy as np
import typer

from benchmarks.command import run
from benchmarks.presentation import markdown
from benchmarks.provenance import provenance
from svgf_cl import Denoiser, Frame
from svgf_cl.bench.tables import Table
from svgf_cl.cli.console import progress_bar, show
from svgf_cl.cli.options import parse_size
from svgf_cl.compare.footage import Choice, Footage
from svgf_cl.compare.metrics import flip, psnr
from svgf_cl.device import devices
from svgf_cl.filters import DEFAULT
from svgf_cl.io.display import Linear, display
from svgf_cl_tracer.cli.footage import open_footage

WARM_UPS = (0, 2, 4, 8, 16, 24, 32)
SCENES = ("cornell", "static", "swing", "switch", "glossy")  # moving camera; nothing; objects; lamps; mirrors
COLUMNS = ("scene", "warm-up", "difference, PSNR", "FLIP", "of a frame's change, %", "truth, PSNR", "whole shot")


def joins(
    scene: Annotated[
        list[str], typer.Argument(metavar="[SCENE]...", help="Built-in scenes, folders with a scene.json, scene files.")
    ] = list(SCENES),  # noqa: B006  # never changed; typer wants the default spelled here
    size: Annotated[str, typer.Option(metavar="WxH", help="Size of the frames.")] = "320x180",
    frames: Annotated[int, typer.Option(metavar="N", min=max(WARM_UPS) + 2, help="Frames of the whole shot.")] = 96,
    spp: Annotated[int, typer.Option(metavar="N", min=2, help="Samples per pixel of the truth.")] = 256,
    jitter: Annotated[
        bool, typer.Option(help="Send rays through a different point of the pixel in every frame.")
    ] = True,
    markdown_: Annotated[bool, typer.Option("--markdown", help="Print the table as markdown.")] = False,
) -> None:
    """Measure joins between chunks by the length of the warm-up, with the default filter.

    PYOPENCL_CTX chooses the device.
    """
    rows: list[list[str]] = []
    choice = Choice(parse_size(size), frames, 1, spp, jitter=jitter)
    for each in [open_footage(name, choice) for name in scene]:
        with progress_bar(each.name, each.steps + 1 + len(WARM_UPS)) as advance:
            rows += rows_of(each, advance)
    table = Table("joins by warm-up", COLUMNS, rows)
    print(markdown(table)) if markdown_ else show(table.title, table.columns, table.rows)
    about = provenance(devices.default_device()) | {"size": size, "frames": str(frames), "truth": f"{spp} spp"}
    print("\n".join(f"{key}: {value}" for key, value in about.items()))


def rows_of(footage: Footage, advance: Callable[[], None]) -> Iterator[list[str]]:
    """The rows of a scene, one for each length of the warm-up."""
    ((first, second),) = footage.truths(advance).values()
    truth = display((first + second) / 2)
    frames = list(footage.frames())
    before, whole = last_two(frames)
    advance()
    change = rms(whole, before)
    for warm_up in WARM_UPS:
        joined = last_two(frames[-1 - warm_up :])[-1]
        advance()
        yield [
            footage.name,
            str(warm_up),
            f"{psnr(joined, whole):.1f}",
            f"{flip(joined, whole):.4f}",
            f"{100 * rms(joined, whole) / change:.0f}",
            f"{psnr(joined, truth):.2f}",
            f"{psnr(whole, truth):.2f}",
        ]


def last_two(frames: Sequence[Frame]) -> Sequence[Linear]:
    """The last two pictures of these frames, as shown; one if there is only one."""
    with Denoiser(frames[0].shape, settings=DEFAULT()) as denoiser:
        return [display(denoiser.denoise(frame)) for frame in frames][-2:]


def rms(one: Linear, other: Linear) -> float:
    """Root mean square of the difference of two pictures."""
    return float(np.sqrt(np.mean(np.square(one - other))))


def main() -> None:
    """Run the command."""
    run(joins, "benchmarks.joins")


if __name__ == "__main__":
    main()
