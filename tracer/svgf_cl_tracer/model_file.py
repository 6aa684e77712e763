"""Loads model files of all kinds that can be read."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from .errors import SceneError
from .gltf import load_gltf
from .model import Model
from .obj import load_obj
from .vectors import Float64

LOADERS: dict[str, Callable[[Path, Float64], Model]] = {".glb": load_gltf, ".gltf": load_gltf, ".obj": load_obj}


def load_model(path: Path, to_world: Float64) -> Model:
    """Load the model at `path`; `to_world` (4, 4) leads from the model's frame into the world's.

    Raises
    ------
    SceneError
        If the file is missing, empty, damaged or of another kind, or contains something that would be shown wrongly.
    """
    if not path.is_file():
        raise SceneError(f"{path}: no such file")
    if path.suffix.lower() not in LOADERS:
        raise SceneError(f"{path}: expected a file called {', '.join(LOADERS)}, found another kind")
    try:
        model = LOADERS[path.suffix.lower()](path, to_world)
        if not model.objects:
            raise SceneError("expected at least one triangle, found none")
        return model
    except SceneError as error:
        raise SceneError(f"{path}: {error}") from error
    # Files may contain anything, and so cause any error; for the user, the file is unreadable.
    except Exception as error:
        reason = " ".join(f"{type(error).__name__}: {error}".split())
        raise SceneError(f"{path}: cannot be read as glTF, GLB or OBJ ({reason})") from error
