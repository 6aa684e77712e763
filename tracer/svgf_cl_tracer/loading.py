"""Loads scenes from files."""

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
    """Load a folder with a scene.json, or a single .gltf, .glb or .obj file.

    Parameters
    ----------
    path : path
    sky : (r, g, b) or Environment, optional
        Radiance that arrives from all directions outside the scene, linear, >= 0; replaces the scene's own sky.
    alternative_lights : bool
        Use the alternative lights of a folder's scene.json.

    Returns
    -------
    Scene
        One instance for each primitive of each node, with ids from 1. The camera path is the one of the description, or
        else of the file's camera, or else shows the whole scene.

    Raises
    ------
    SceneError
        If the file is missing or unreadable, or has no triangle, or if nothing in it emits light and no sky is given.
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
