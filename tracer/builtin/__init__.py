"""The built-in scenes, which need no file."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from ..errors import SceneError
from ..scene import Scene
from . import blur, contrast, cornell, fence, fireflies, glossy, mirror, sliding, static, swing, switch


@dataclass(frozen=True)
class Builtin:
    """A scene made to be hard for a denoiser.

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
    "cornell": Builtin(cornell.make, "soft light between coloured walls, thin bars", 24),
    "glossy": Builtin(glossy.make, "reflections of every sharpness, which move unlike their surface", 24),
    "mirror": Builtin(mirror.make, "edges and textures that no feature of the first hit tells", 24),
    "sliding": Builtin(sliding.make, "a texture in motion under a shadow that stays", 48),
    "switch": Builtin(switch.make, "a lamp goes off at 0.5 s and on at 1 s: lag", 48),
    "swing": Builtin(swing.make, "disocclusion, and a shadow that moves over still things", 48),
    "fence": Builtin(fence.make, "bars, wires and leaves thinner than a pixel", 24),
    "fireflies": Builtin(fireflies.make, "tiny bright lamps seen only indirectly", 24),
    "blur": Builtin(blur.make, "depth of field and motion blur: no pixel has one depth or motion", 24),
    "static": Builtin(static.make, "nothing moves: temporal stability of detail and soft shadows", 24),
    "contrast": Builtin(contrast.make, "sun and darkness in one picture", 24),
}


def builtin_scene(name: str = "cornell") -> Scene:
    """Make the built-in scene `name`.

    Raises
    ------
    SceneError
        There is no such scene.
    """
    if name not in BUILTIN:
        raise SceneError(f"no built-in scene {name!r}; there is: {', '.join(BUILTIN)}")
    return BUILTIN[name].make()
