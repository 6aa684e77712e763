"""Scenes from files."""

from __future__ import annotations

from os import PathLike
from pathlib import Path

import numpy as np

from .description import FILE_NAME, described_scene
from .errors import SceneError
from .materials import Colour
from .model_file import LOADERS, load_model
from .scene import Scene
from .sky import Environment


def load_scene(
    path: str | PathLike[str], sky: Colour | Environment | None = None, *, alternative_lights: bool = False
) -> Scene:
    """Load a folder with a scene.json, or a .gltf, .glb or .obj file by itself.

    Parameters
    ----------
    path : path
    sky : (r, g, b) or Environment, optional
        Radiance that comes from everywhere outside the scene, linear, >= 0; in place of the scene's own.
    alternative_lights : bool
        Light a folder's scene by the other lights that its scene.json has.

    Returns
    -------
    Scene
        One instance for each primitive of each node, ids from 1. Its camera path is the one described, else that of
        the file's camera, else one that frames everything.

    Raises
    ------
    SceneError
        The file is missing or unreadable, holds no triangle, or nothing in it emits light and no sky is given.
    """
    path = Path(path)
    if path.is_dir():
        return _load_folder(path, sky, alternative_lights)
    if alternative_lights:
        raise SceneError(f"{path}: expected a folder with a {FILE_NAME} that has alternative lights, got a file")
    model = load_model(path, np.eye(4))
    try:
        return Scene(
            [item.instance for item in model.objects],
            lights=[item.light for item in model.lights],
            sky=sky,
            camera_path=model.eye.path if model.eye else None,
        )
    except SceneError as error:
        raise SceneError(f"{path}: {error}") from error


def _load_folder(folder: Path, sky: Colour | Environment | None, alternative_lights: bool) -> Scene:
    if not (folder / FILE_NAME).is_file():
        models = ", ".join(str(path) for path in sorted(folder.iterdir()) if path.suffix.lower() in LOADERS)
        advice = f"name a model to render it as it is: {models}" if models else "there is no model either"
        raise SceneError(f"{folder}: expected a {FILE_NAME} in this folder, found none; {advice}")
    return described_scene(folder, sky, alternative_lights=alternative_lights)
