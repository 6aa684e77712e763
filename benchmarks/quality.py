"""The filters beside each other and beside Open Image Denoise: how good their pictures are, and how long they take.

docs/benchmarks.md says how it is measured; `svgf_cl.compare` defines the measures.
"""

from __future__ import annotations

from collections.abc import Mapping
from importlib.metadata import version
from pathlib import Path
from typing import Annotated

import typer

from benchmarks.command import run
from benchmarks.contest import TRUTH, compete
from benchmarks.footage import Footage
from benchmarks.presentation import markdown
from benchmarks.provenance import provenance
from benchmarks.quality_tables import scene_table, summary, write_json
from benchmarks.rivals import USUAL, antialiased, parse_filters, rivals
from svgf_cl.bench.tables import Table
from svgf_cl.cli.console import progress_bar, show
from svgf_cl.cli.options import parse_size
from svgf_cl.compare.metrics import SSIM_WINDOW, require_flip, require_ssim
from svgf_cl.compare.oidn import require_oidn
from svgf_cl.device import devices
from svgf_cl.errors import SvgfError
from svgf_cl.io.atomic import output_file, output_folder
from svgf_cl.io.display import Linear, to_bytes, write_image
from svgf_cl.io.panels import contact_sheet, magnified, worst_piece
from svgf_cl_tracer import BUILTIN

SETTLED = 8  # the first judged frame: history is nearly as long then as it gets
FRAMES = 24  # of a scene that does not say how many show it


def quality(
    scene: Annotated[
        list[str], typer.Argument(metavar="[SCENE]...", help="Built-in scenes, folders with a scene.json, scene files.")
    ] = list(BUILTIN),  # noqa: B006  # never changed; typer wants the default spelled here
    size: Annotated[str, typer.Option(metavar="WxH", help="Size of the frames.")] = "256x144",
    frames: Annotated[
        int | None,
        typer.Option(
            metavar="N",
            min=2,
            help="Frames. By default as many as show a built-in scene, 24 of another.",
            show_default=False,
        ),
    ] = None,
    spp: Annotated[int, typer.Option(metavar="N", min=2, help="Samples per pixel of the truth.")] = 256,
    jitter: Annotated[
        bool | None,
        typer.Option(
            help="Move the rays within the pixel, or do not. By default both are compared.", show_default=False
        ),
    ] = None,
    filter_: Annotated[
        list[str],
        typer.Option("--filter", metavar="NAME[,SETTING=VALUE]...", help="A filter to compare; may be repeated."),
    ] = list(USUAL),  # noqa: B006
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="DIR", help="Write pictures of each scene there, too.")
    ] = None,
    picture: Annotated[
        list[int],
        typer.Option(
            metavar="N",
            help="Frame to write; may be repeated. By default the middle of those judged.",
            show_default=False,
        ),
    ] = [],  # noqa: B006
    json_: Annotated[Path | None, typer.Option("--json", metavar="FILE", help="Write all figures there, too.")] = None,
    markdown_: Annotated[bool, typer.Option("--markdown", help="Print tables as markdown.")] = False,
) -> None:
    """Compare what filters, and Open Image Denoise where it is installed, make of sequences with path-traced truth.

    PYOPENCL_CTX chooses the device. The truth takes minutes a scene to render. It is kept in the user's cache folder as
    it grows: after a break the same command goes on where it was.
    """
    require_flip()
    require_ssim()
    footages = [footage(each, size, frames, spp, jitter=rays) for rays in both(jitter) for each in scene]
    texts = {rays: antialiased(filter_) if rays else filter_ for rays in both(jitter)}
    wanted = {each: pictured(each, picture) for each in footages}
    folder = output_folder(output) if output else None
    if json_:
        output_file(json_)
    missing = why_no_oidn()
    about = provenance(devices.default_device()) | {"size": size, "truth": f"{spp} spp"}
    about["Open Image Denoise"] = missing or f"pyoidn {version('pyoidn')}"
    results = []
    for each in footages:
        with progress_bar(each.scene, each.chunks + each.frames) as advance:
            taking_part = rivals(parse_filters(texts[each.jitter]), each.shape, oidn=not missing)
            result, pictures = compete(each, taking_part, wanted[each], advance)
        results.append(result)
        print_table(scene_table(result), as_markdown=markdown_)
        if json_:
            write_json(json_, about, results)
        if folder:
            for number, panels in pictures.items():
                stem = f"{Path(each.scene).stem}.{each.name}.{number:04d}"
                write_panels(folder, stem, panels, filter_[0])
    for table in summary(results):
        print_table(table, as_markdown=markdown_)
    print("\n".join(f"{key}: {value}" for key, value in about.items()))


def both(jitter: bool | None) -> list[bool]:
    """Which rays to compare with."""
    return [False, True] if jitter is None else [jitter]


def footage(scene: str, size: str, frames: int | None, spp: int, *, jitter: bool) -> Footage:
    """The sequence of a scene, all its frames from `SETTLED` on with a truth; at least two, if it is shorter."""
    shape = parse_size(size)
    if min(shape) < SSIM_WINDOW:
        raise SvgfError(f"--size: expected at least {SSIM_WINDOW}x{SSIM_WINDOW} pixels, which SSIM needs, got {size}")
    count = frames or (BUILTIN[scene].frames if scene in BUILTIN else FRAMES)
    name, last = "area" if jitter else "centre", max(2, count - SETTLED)
    return Footage(name, jitter, scene, shape=shape, band=(0, 1), frames=count, last=last, spp=spp)


def pictured(footage: Footage, numbers: list[int]) -> list[int]:
    """The frames of which to write pictures."""
    judged = footage.judged
    for number in numbers:
        if number not in judged:
            raise SvgfError(
                f"--picture: expected frames out of {judged.start}..{judged.stop - 1} of {footage.scene}, got {number}"
            )
    return numbers or [judged[len(judged) // 2]]


def why_no_oidn() -> str:
    """What to say where Open Image Denoise is not installed; nothing where it is."""
    try:
        require_oidn()
    except SvgfError as error:
        return f"not compared; {error}"
    return ""


def print_table(table: Table, *, as_markdown: bool) -> None:
    """Print a table."""
    print(f"{table.title}:\n\n{markdown(table)}") if as_markdown else show(table.title, table.columns, table.rows)


def write_panels(folder: Path, stem: str, pictures: Mapping[str, Linear], tested: str) -> None:
    """Write all pictures of a frame on one sheet, and on another a piece of each: where `tested` is worst."""
    shown = {name: to_bytes(picture) for name, picture in pictures.items()}
    piece = worst_piece(shown[tested], shown[TRUTH])
    pieces = {name: magnified(picture[piece], picture.shape) for name, picture in shown.items()}
    write_image(folder / f"{stem}.png", contact_sheet(shown))
    write_image(folder / f"{stem}.detail.png", contact_sheet(pieces))


def main() -> None:
    """Run the command."""
    run(quality, "benchmarks.quality")


if __name__ == "__main__":
    main()
