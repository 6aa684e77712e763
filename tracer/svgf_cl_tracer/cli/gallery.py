"""``svgf-cl scenes``: lists the built-in scenes with thumbnails, and draws contact sheets of scenes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import numpy as np
import typer
from rich.color import Color
from rich.style import Style
from rich.table import Table
from rich.text import Text

from svgf_cl.cli.console import screen, tracked
from svgf_cl.cli.options import Exposure, Size, parse_size
from svgf_cl.errors import SvgfError
from svgf_cl.frame import Shape
from svgf_cl.io.atomic import output_file
from svgf_cl.io.display import Bytes, automatic_exposure, to_bytes, write_image
from svgf_cl_tracer.cli.scenes import open_scene, read_sky, require_tracer

# Size of a thumbnail in a terminal, (height, width); a character shows two pixels.
THUMBNAIL = (18, 32)

FORMATS = (".png", ".webp")

if TYPE_CHECKING:
    from svgf_cl_tracer import Environment

    Sky = tuple[float, float, float] | Environment


def scenes(
    others: Annotated[
        list[str],
        typer.Argument(metavar="SCENE", help="Scene files and folders to show before the built-in ones."),
    ] = [],  # noqa: B006  # never changed; typer wants the default spelled here
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="FILE", help="Write a contact sheet: .png or .webp.")
    ] = None,
    size: Size = "480x270",
    spp: Annotated[int, typer.Option(metavar="N", min=1, help="Samples per pixel.")] = 64,
    sky: Annotated[
        str | None,
        typer.Option(metavar="R,G,B|FILE", help="Sky around the given files, as in render; a folder has its own."),
    ] = None,
    exposure: Exposure = 0.0,
) -> None:
    """List the built-in scenes, and why each is hard to denoise.

    The list also says how many frames each scene has. Shows thumbnails if the terminal has colours. With --output,
    draws all scenes on a contact sheet, each with --size. Each picture shows the middle frame with its own exposure, to
    which --exposure is added.

    \b
    Examples:
      svgf-cl scenes
      svgf-cl scenes -o scenes.png
      svgf-cl scenes my_scene Fox.glb --sky 1,1,1 --size 640x360 -o all.webp
    """
    require_tracer()
    from svgf_cl.io.panels import contact_sheet

    shape, light = parse_size(size), read_sky(sky) if sky else None
    entries = [*(Entry(name) for name in others), *built_in()]
    draw = partial(middle_frame, spp=spp, sky=light, exposure=exposure)
    if output is None:
        list_scenes(entries, draw)
        return
    if output.suffix not in FORMATS:
        raise SvgfError(f"--output: expected a file named *{' or *'.join(FORMATS)}, got {output}")
    output_file(output)
    rendered = tracked(entries, len(entries), "rendering")
    write_image(output, contact_sheet({entry.caption: draw(entry, shape) for entry in rendered}))
    print(f"{len(entries)} scenes in {output}")


@dataclass(frozen=True)
class Entry:
    """A scene to show: a built-in scene, or a file or folder."""

    name: str
    hard: str = ""
    frames: int = 1

    @property
    def caption(self) -> str:
        """The text above its picture."""
        return f"{self.name}: {self.hard}" if self.hard else self.name


def built_in() -> list[Entry]:
    """The built-in scenes."""
    from svgf_cl_tracer import BUILTIN

    return [Entry(name, scene.hard, scene.frames) for name, scene in BUILTIN.items()]


def middle_frame(entry: Entry, shape: Shape, *, spp: int, sky: Sky | None, exposure: float) -> Bytes:
    """Render the frame in the middle of a scene's sequence, as a picture for display."""
    from svgf_cl_tracer import Shot, render_frame

    scene = open_scene(entry.name, sky if Path(entry.name).is_file() else None)
    color = np.asarray(render_frame(Shot(scene, shape, entry.frames), entry.frames // 2, spp=spp).color)
    return to_bytes(color, automatic_exposure(color) + exposure)


def list_scenes(entries: Sequence[Entry], draw: Callable[[Entry, Shape], Bytes]) -> None:
    """Print a table of scenes, with thumbnails if the terminal has colours."""
    console = screen()
    coloured = console.color_system is not None
    table = Table("scene", "frames", "what is hard", *(["middle frame"] if coloured else []), show_lines=coloured)
    for entry in tracked(entries, len(entries), "rendering") if coloured else entries:
        thumbnail = [half_blocks(draw(entry, THUMBNAIL))] if coloured else []
        table.add_row(entry.name, str(entry.frames), entry.hard, *thumbnail)
    console.print(table)


def half_blocks(shown: Bytes) -> Text:
    """Draw a picture (H, W, 3) of even height in coloured characters, each of which shows two pixels."""
    text = Text()
    for upper, lower in zip(shown[::2].tolist(), shown[1::2].tolist(), strict=True):
        for over, under in zip(upper, lower, strict=True):
            text.append("\u2580", Style(color=Color.from_rgb(*over), bgcolor=Color.from_rgb(*under)))
        text.append("\n")
    text.rstrip()
    return text
