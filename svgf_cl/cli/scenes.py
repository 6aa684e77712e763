"""The tracer is optional: finding it, and opening a scene with it."""

from __future__ import annotations

import signal
from pathlib import Path
from typing import TYPE_CHECKING

from svgf_cl.errors import SvgfError

if TYPE_CHECKING:
    from tracer import Scene


def require_tracer() -> None:
    """Raise `SvgfError`, with the command that installs it, where the tracer or something it needs is missing."""
    # trimesh swallows KeyboardInterrupt while it is being imported: until then Ctrl-C ends the process by itself.
    interrupt = signal.signal(signal.SIGINT, signal.SIG_DFL)
    try:
        import tracer  # noqa: F401
    except ModuleNotFoundError as error:
        raise SvgfError(
            f"rendering needs the tracer ({error}): pip install '.[tracer]' in a clone of svgf_cl"
        ) from error
    finally:
        signal.signal(signal.SIGINT, interrupt)


def open_scene(name: str, sky: tuple[float, float, float] | None) -> Scene:
    """Open the scene in file `name`, or make the built-in one of that name.

    Raises
    ------
    SvgfError
        Where there is neither, where the file cannot be used, or where a built-in scene is given a sky.
    """
    import tracer

    if Path(name).is_file():
        return tracer.load_scene(Path(name), sky=sky)
    if name not in tracer.BUILTIN:
        known = ", ".join(tracer.BUILTIN)
        raise SvgfError(f"{name}: expected a scene file or a built-in scene ({known}), found nothing of that name")
    if sky:
        raise SvgfError(
            f"--sky: expected a scene file to light, got the built-in scene {name}, which has its own lamps"
        )
    return tracer.builtin_scene(name)
