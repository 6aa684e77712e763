"""Makes a scene from a description and its model."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence, Set
from dataclasses import replace
from pathlib import Path

import numpy as np

from svgf_cl_tracer.camera import CameraPath
from svgf_cl_tracer.errors import SceneError
from svgf_cl_tracer.materials import Colour, Material
from svgf_cl_tracer.model import Model
from svgf_cl_tracer.model_file import load_model
from svgf_cl_tracer.panorama import load_environment
from svgf_cl_tracer.scene import Scene
from svgf_cl_tracer.sky import Environment

from .animation import AnyAnimation
from .document import FILE_NAME, SceneDescription, read_description
from .lights import AnyLight, AreaLight, ConstantSky, EnvironmentMap, Rectangle, SunLight
from .materials import AnyMaterial


def described_scene(
    folder: Path, sky: Colour | Environment | None = None, *, alternative_lights: bool = False
) -> Scene:
    """Make the scene that `folder` describes.

    Parameters
    ----------
    folder : Path
        A folder with a scene.json.
    sky : (r, g, b) or Environment, optional
        Replaces the sky of the description.
    alternative_lights : bool
        Use `alternative_lights` of the description.

    Raises
    ------
    SceneError
        If the description or its model cannot be used, or the two do not match.
    """
    path = folder / FILE_NAME
    description = read_description(path)
    try:
        lights = _chosen(description, alternative_lights)
        model = load_model(_inside(folder, description.model), description.to_world())
        model = _painted(_animated(model, description.animations()), description.materials, lights)
        cameras = [view.camera() for view in description.views()]
        own = model.eye.path if model.eye else None
        rectangles = [light.instance() for light in lights if isinstance(light, Rectangle)]
        suns = [light.light() for light in lights if isinstance(light, SunLight)]
        return Scene(
            [*(item.instance for item in model.objects), *rectangles],
            lights=[*(item.light for item in model.lights), *suns],
            sky=_sky(folder, lights) if sky is None else sky,
            camera_path=CameraPath.through(cameras) if cameras else own,
        )
    except SceneError as error:
        raise SceneError(f"{path}: {error}") from error


def _chosen(description: SceneDescription, alternative: bool) -> Sequence[AnyLight]:
    if alternative and not description.alternative_lights:
        raise SceneError("alternative_lights: expected at least one light, found none; render it without them")
    return description.alternative_lights if alternative else description.lights


def _inside(folder: Path, name: str) -> Path:
    """The file `name` in `folder` or below it; a description must not read any other files."""
    try:
        path = (folder / name).resolve()
        path.is_file()
    # a loop of links, a name that is too long, or a name with a zero byte
    except (OSError, RuntimeError, ValueError) as error:
        raise SceneError(f"expected the name of a file, found {name!r}: {error}") from error
    if not path.is_relative_to(folder.resolve()):
        raise SceneError(f"expected a file inside the scene's folder, found {name!r}")
    return folder / name


def _sky(folder: Path, lights: Sequence[AnyLight]) -> Colour | Environment | None:
    for light in lights:
        if isinstance(light, ConstantSky):
            return light.radiance
        if isinstance(light, EnvironmentMap):
            return load_environment(_inside(folder, light.file), np.array(light.to_world_rows))
    return None


def _animated(model: Model, animations: Sequence[AnyAnimation]) -> Model:
    """The model with motion added to its nodes."""
    for animation in animations:
        _check_names("animation: nodes", animation.nodes, model.nodes)
        model = model.carried(frozenset(animation.nodes), animation.motion())
    return model


def _painted(model: Model, materials: Mapping[str, AnyMaterial], lights: Sequence[AnyLight]) -> Model:
    """The model with the described materials; materials of area lights emit light."""
    radiance = {light.material: light.radiance for light in lights if isinstance(light, AreaLight)}
    known = {item.material for item in model.objects}
    _check_names("materials", materials, known)
    _check_names("lights: material", radiance, known)

    def paint(name: str, material: Material) -> Material:
        if name in materials:
            material = _described(name, materials[name], material)
        if name in radiance:
            material = replace(material, emission=radiance[name], emission_texture=None)
        return material

    return model.painted(paint)


def _described(name: str, description: AnyMaterial, material: Material) -> Material:
    try:
        return description.on(material)
    except SceneError as error:
        raise SceneError(f"materials.{name}: {error}") from error


def _check_names(where: str, names: Iterable[str], known: Set[str]) -> None:
    """Raise `SceneError` unless the model has all of `names`."""
    for name in names:
        if name not in known:
            there = ", ".join(sorted(filter(None, known))) or "it names none"
            raise SceneError(f"{where}: expected names of the model ({there}), found {name!r}")
