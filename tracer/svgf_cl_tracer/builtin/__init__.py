"""The built-in scenes, which need no file."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from ..errors import SceneError
from ..scene import Scene
from . import blur, contrast, cornell, fence, fireflies, glossy, mirror, sliding, static, swing, switch


@dataclass(frozen=True)
class Builtin:
    """A scene that is hard for a denoiser.

    Parameters
    ----------
    make : callable
        Makes the scene.
    hard : str
        What is hard about it, in a few words.
    frames : int
        Length of a sequence that shows it, at 24 frames per second.
    """

    make: Callable[[], Scene]
    hard: str
    frames: int


BUILTIN = {
    "cornell": Builtin(cornell.make, "indirect light, thin bars", 24),
    "glossy": Builtin(glossy.make, "reflections of every sharpness", 24),
    "mirror": Builtin(mirror.make, "edges that no feature tells", 24),
    "sliding": Builtin(sliding.make, "texture moves, shadow stays", 48),
    "switch": Builtin(switch.make, "lag of a lamp off and on", 48),
    "swing": Builtin(swing.make, "disocclusion, shadow lag", 48),
    "fence": Builtin(fence.make, "bars and leaves below a pixel", 24),
    "fireflies": Builtin(fireflies.make, "tiny lamps, seen indirectly", 24),
    "blur": Builtin(blur.make, "wide lens and open shutter", 24),
    "static": Builtin(static.make, "flicker where nothing moves", 24),
    "contrast": Builtin(contrast.make, "sun and night in one picture", 24),
}


def builtin_scene(name: str = "cornell") -> Scene:
    """Make the built-in scene `name`.

    Raises
    ------
    SceneError
        If there is no such scene.
    """
    if name not in BUILTIN:
        raise SceneError(f"no built-in scene {name!r}; there is: {', '.join(BUILTIN)}")
    return BUILTIN[name].make()
