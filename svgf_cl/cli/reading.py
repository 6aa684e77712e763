"""The options that say how to read frames of other renderers."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any

import typer

from svgf_cl.errors import SvgfError, shown
from svgf_cl.io.atomic import require
from svgf_cl.io.cameras import NAME
from svgf_cl.io.readers import READERS
from svgf_cl.io.reading import ReadAs

Format = Annotated[
    str | None,
    typer.Option(
        "--format",
        metavar="NAME",
        help=f"Renderer of the frames: {' or '.join(READERS)}. By default, the first file shows it.",
    ),
]
Maps = Annotated[
    list[str],
    typer.Option(
        "--map",
        metavar="FIELD=PASS",
        help="Read a field from a pass with another name: --map depth=Z,normal=N. May be repeated.",
    ),
]
ViewLayer = Annotated[
    str | None, typer.Option("--view-layer", metavar="NAME", help="View layer to read, if files have several.")
]
Cameras = Annotated[
    Path | None,
    typer.Option(
        "--cameras",
        metavar="FILE",
        help=f"Cameras to compute motion and depth from, if files lack them. By default {NAME} beside the frames.",
    ),
]
StillCamera = Annotated[
    bool, typer.Option("--still-camera", help="If neither files nor cameras give motion, assume that nothing moves.")
]
MotionScale = Annotated[
    float, typer.Option("--motion-scale", metavar="X", help="Multiply motion by X, if it is not in pixels.")
]
MotionFlip = Annotated[
    str, typer.Option("--motion-flip", metavar="AXES", help="Reverse the sign of motion along x, y or xy.")
]


def reads_frames(command: Callable[..., None]) -> Callable[..., None]:
    """Give a command the options of `read_as` in place of its parameter `how`, which is the resulting `ReadAs`."""
    parameters = dict(inspect.signature(command, eval_str=True).parameters)
    options = inspect.signature(read_as, eval_str=True).parameters
    del parameters["how"]

    @functools.wraps(command)
    def with_options(**given: Any) -> None:
        how = read_as(**{name: given.pop(name) for name in options})
        command(**given, how=how)

    with_options.__signature__ = inspect.Signature([*parameters.values(), *options.values()])  # type: ignore[attr-defined]
    return with_options


def read_as(
    *,
    format_: Format = None,
    maps: Maps = [],  # noqa: B006  # never changed; typer needs the default here
    view_layer: ViewLayer = None,
    cameras: Cameras = None,
    still_camera: StillCamera = False,
    motion_scale: MotionScale = 1.0,
    motion_flip: MotionFlip = "",
) -> ReadAs:
    """Return the options as a `ReadAs`; raise `SvgfError` if one of them is wrong."""
    if motion_flip not in ("", "x", "y", "xy"):
        raise SvgfError(f"--motion-flip: expected x, y or xy, got {shown(motion_flip)}")
    if not 0 < motion_scale < 1e9:
        raise SvgfError(f"--motion-scale: expected a number above 0, got {motion_scale:g}")
    if cameras:
        require(cameras)
    scale = tuple(-motion_scale if axis in motion_flip else motion_scale for axis in "xy")
    return ReadAs(
        format=format_,
        view_layer=view_layer,
        passes=parse_maps(maps),
        motion_scale=(scale[0], scale[1]),
        cameras=cameras or {},
        still_camera=still_camera,
    )


def refuse_reading(how: ReadAs, found: str) -> None:
    """Raise `SvgfError` if an option of reading is given, but this was found in place of frames."""
    if how != ReadAs():
        raise SvgfError(f"--format, --map and other options of reading: expected frames in files, got {found}")


def parse_maps(texts: Sequence[str]) -> Mapping[str, str]:
    """Read ``["depth=Z,normal=N"]`` as a mapping of fields to passes."""
    found = {}
    for text in (part for each in texts for part in each.split(",")):
        name, _, wanted = text.partition("=")
        if not wanted:
            raise SvgfError(f"--map: expected FIELD=PASS such as depth=Z, got {shown(text)}")
        found[name.strip()] = wanted.strip()
    return found
