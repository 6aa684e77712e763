"""``svgf-cl view``: plays noisy, denoised and reference pictures side by side in the browser."""

from __future__ import annotations

import webbrowser
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from svgf_cl.cli.compare import is_scene, refuse_rendering
from svgf_cl.cli.console import progress_bar
from svgf_cl.cli.options import (
    MAX_FRAMES,
    AllowGaps,
    Exposure,
    FilterName,
    SettingTexts,
    parse_measured_size,
    parse_settings,
)
from svgf_cl.cli.reading import reads_frames, refuse_reading
from svgf_cl.cli.remarks import described
from svgf_cl.errors import SvgfError
from svgf_cl.filters import DEFAULT
from svgf_cl.io.reading import ReadAs
from svgf_cl.io.sequence import find_frames, number_of
from svgf_cl.io.shot import Shot

if TYPE_CHECKING:
    from svgf_cl.view.clip import Clip

SIZE = "640x360"


@reads_frames
def view(
    inputs: Annotated[
        list[str],
        typer.Argument(
            metavar="FRAMES|SCENE",
            help="The EXR files of one shot, as for svgf-cl denoise; or a scene to render. By default a room that "
            "needs no files.",
        ),
    ] = [],  # noqa: B006  # never changed; typer needs the default here
    reference: Annotated[
        Path | None,
        typer.Option(metavar="REF", help="References of the frames: a folder of pictures, or one picture."),
    ] = None,
    filter_: FilterName = DEFAULT.name,
    set_: SettingTexts = [],  # noqa: B006
    exposure: Exposure = 0.0,
    port: Annotated[
        int, typer.Option(metavar="N", min=0, max=65535, help="Port of the page on this machine [any free one].")
    ] = 0,
    browser: Annotated[bool, typer.Option("--browser/--no-browser", help="Open the page, or only say where it is.")] = (
        True
    ),
    size: Annotated[str, typer.Option(metavar="WxH", help=f"Size of rendered frames [{SIZE}].")] = "",
    frames: Annotated[
        int | None,
        typer.Option(metavar="N", min=1, max=MAX_FRAMES, help="Number of frames to render [the scene's own]."),
    ] = None,
    spp: Annotated[
        int | None,
        typer.Option(
            metavar="N",
            min=2,
            help="Also render references of the scene with N samples per pixel; they are stored for the next run.",
        ),
    ] = None,
    jitter: Annotated[
        bool, typer.Option(help="Move the scene's rays within the pixel, with a new offset in each frame.")
    ] = False,
    allow_gaps: AllowGaps = False,
    *,
    how: ReadAs,
) -> None:
    """Play noisy and denoised frames in the browser, to see flicker.

    Noisy, denoised and reference pictures are side by side. You can change filter and settings while they play. Frames
    of files are denoised as svgf-cl denoise does. Scenes are rendered at 1 sample per pixel while they are first
    played, and stay in memory. Only this machine can reach the page. Ctrl-C ends it.

    \b
    Examples:
      svgf-cl view
      svgf-cl view cornell --spp 64
      svgf-cl view fence --jitter --set taa=on
      svgf-cl view 'shot/####.exr' --filter svgf
      svgf-cl view out/demo/noisy --reference out/demo/reference --set taa=on
    """
    from svgf_cl.device.devices import default_device
    from svgf_cl.view.player import Player
    from svgf_cl.view.server import Server, Start

    settings = parse_settings(filter_, set_)
    is_files = bool(inputs) and not any(map(is_scene, inputs))
    if is_files:
        refuse_rendering({"--size": size, "--frames": frames, "--spp": spp, "--jitter": jitter})
    else:
        refuse_reading(how, "a scene")
        refuse_files({"--reference": reference, "--allow-gaps": allow_gaps})
    shape = parse_measured_size(size or SIZE)
    with Server(port) as server:  # a port in use is reported before anything is rendered
        if is_files:
            clip: Clip = of_files(inputs, reference, how, allow_gaps=allow_gaps)
        else:
            clip = of_scene(inputs, shape, frames, spp, jitter=jitter)
        player = Player(clip, settings)
        print(f"{clip.name}: {server.url} (Ctrl-C ends it)", flush=True)
        if browser:
            webbrowser.open(server.url)
        server.play(player, Start(settings, exposure, default_device().name.strip()))


def refuse_files(options: Mapping[str, object]) -> None:
    """Raise `SvgfError` if an option for files is given, but there are no files."""
    for name, value in options.items():
        if value:
            raise SvgfError(f"{name}: expected frames in files, got a scene")


def of_files(inputs: Sequence[str], reference: Path | None, how: ReadAs, *, allow_gaps: bool) -> Clip:
    """Return the clip of a user's frames."""
    from svgf_cl.compare.recorded import find_references
    from svgf_cl.view.files import FilesClip

    shot = Shot(find_frames(map(Path, inputs), allow_gaps=allow_gaps), how)
    print(described(shot, shot.read(0)))
    numbers = [number_of(path) for path in shot.paths]
    return FilesClip(shot, find_references(reference, numbers) if reference else {})


def of_scene(
    inputs: Sequence[str], shape: tuple[int, int], frames: int | None, spp: int | None, *, jitter: bool
) -> Clip:
    """Return the clip of a scene, or of the room if no scene is named."""
    from svgf_cl.view.scenes import open_footage, room, scene

    if not inputs:
        refuse_of_room(spp, jitter=jitter)
        return room(shape, frames)
    if len(inputs) > 1:
        raise SvgfError(f"expected one scene, or only frames, got {len(inputs)} arguments with a scene among them")
    footage = open_footage(inputs[0], shape, frames, spp, jitter=jitter)
    typer.echo(f"{footage.name}: rendering the first two frames, then the page opens", err=True)
    with progress_bar("references", footage.steps if spp else 0) as advance:
        return scene(footage, has_references=spp is not None, advance=advance)


def refuse_of_room(spp: int | None, *, jitter: bool) -> None:
    """Raise `SvgfError` if an option of scenes is given for the room."""
    if spp is not None:
        raise SvgfError("--spp: expected a scene, got none; the references of the room are exact")
    if jitter:
        raise SvgfError("--jitter: expected a scene, got none; the room is seen through pixel centres")
