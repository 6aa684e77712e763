"""Opens scenes with the tracer, and checks that this optional part is installed."""

from __future__ import annotations

import signal
from pathlib import Path
from typing import TYPE_CHECKING, TextIO

from svgf_cl.errors import SvgfError, install_extra

if TYPE_CHECKING:
    from svgf_cl_tracer import Environment, Scene


def require_tracer(remarks: TextIO | None = None) -> None:
    """Raise `SvgfError`, with the command that installs it, if the tracer or one of its dependencies is missing.

    If the tracer has to be compiled first, a line on `remarks` (by default the standard output) says so.
    """
    # trimesh swallows KeyboardInterrupt while it is imported; until then Ctrl-C ends the process directly.
    interrupt = signal.signal(signal.SIGINT, signal.SIG_DFL)
    try:
        import svgf_cl_tracer.api  # noqa: F401
    except ModuleNotFoundError as error:
        raise SvgfError(f"rendering needs the tracer ({error}): {install_extra('tracer')}") from error
    finally:
        signal.signal(signal.SIGINT, interrupt)
    from svgf_cl_tracer.compiled import IS_KEPT, was_compiled

    if not was_compiled():
        print(f"compiling the tracer: some twenty seconds{', this once' if IS_KEPT else ''}", file=remarks, flush=True)


def read_sky(text: str) -> tuple[float, float, float] | Environment:
    """Read the value of ``--sky``: three radiances, or the path of an image.

    Raises
    ------
    SvgfError
        If it is neither, or the image cannot be used.
    """
    import svgf_cl_tracer

    return svgf_cl_tracer.load_environment(text) if Path(text).suffix.lower() in (".hdr", ".exr") else parse_rgb(text)


def parse_rgb(text: str) -> tuple[float, float, float]:
    """Read ``0.4,0.5,0.7`` as three radiances >= 0."""
    try:
        red, green, blue = (float(part) for part in text.split(","))
    except ValueError as error:
        raise SvgfError(
            f"--sky: expected three numbers such as 0.4,0.5,0.7 or a file .hdr or .exr, got {text!r}"
        ) from error
    if not all(0 <= value < float("inf") for value in (red, green, blue)):
        raise SvgfError(f"--sky: expected finite radiance >= 0, got {text!r}")
    return red, green, blue


def open_scene(
    name: str, sky: tuple[float, float, float] | Environment | None, *, alternative_lights: bool = False
) -> Scene:
    """Open the scene in the file or folder `name`, or make the built-in scene of that name.

    Raises
    ------
    SvgfError
        If there is neither, if the file cannot be used, or if other lights are requested for a built-in scene.
    """
    import svgf_cl_tracer

    if name in svgf_cl_tracer.BUILTIN:
        if sky or alternative_lights:
            raise SvgfError(
                f"{name}: expected a file or folder to light otherwise, got a built-in scene with its own lamps"
            )
        return svgf_cl_tracer.builtin_scene(name)
    if not Path(name).exists():
        known = ", ".join(svgf_cl_tracer.BUILTIN)
        raise SvgfError(f"{name}: expected a scene's folder or file or a built-in scene ({known}), found nothing")
    return svgf_cl_tracer.load_scene(name, sky, alternative_lights=alternative_lights)
