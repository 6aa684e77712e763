"""The file as a whole: read, checked, and what is wrong with it said in one line."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, ValidationError, field_validator

from svgf_cl_tracer.errors import SceneError
from svgf_cl_tracer.vectors import Float64

from .animation import AnyAnimation
from .complaints import complaint
from .lights import AnyLight, ConstantSky, EnvironmentMap
from .materials import AnyMaterial
from .values import Part, unit
from .view import View

FILE_NAME = "scene.json"
MAX_BYTES = 2**24

# From the model's frame to the world's, whose +y is up: a turn about +x.
TURNS = {"y": np.eye(4), "z": np.array([[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]], np.float64)}


class SceneDescription(Part, title="Scene"):
    """A scene: a model, and what its file lacks. Positions are in the world: +y is up, in metres."""

    model: str = Field(description="A .glb, .gltf or .obj file in the description's folder.")
    up_axis: Literal["y", "z"] = Field("y", description="The model's axis that is up.")
    metres_per_unit: Annotated[float, Field(gt=0), unit("m")] = Field(1.0, description="The model's unit of length.")
    camera: View | list[View] | None = Field(
        None,
        description="One, or several that it moves through in equal times. Absent, the model's or one that sees all.",
    )
    lights: list[AnyLight] = Field([], description="Besides the lights of the model; at most one of them a sky.")
    alternative_lights: list[AnyLight] = Field([], description="In place of `lights` with `--alternative-lights`.")
    materials: dict[str, AnyMaterial] = Field(
        {}, description="In place of the model's materials of these names, emission included."
    )
    animation: AnyAnimation | list[AnyAnimation] | None = Field(
        None, description="A motion, or several; where they share a node, each is on top of those before it."
    )
    units: str = Field("", description="For information.")
    dropped: str = Field(
        "", description="For information: what the model was without when it was made from its source."
    )

    @field_validator("lights", "alternative_lights")
    @classmethod
    def _one_sky(cls, lights: list[AnyLight]) -> list[AnyLight]:
        skies = [light.type for light in lights if isinstance(light, ConstantSky | EnvironmentMap)]
        if len(skies) > 1:
            raise ValueError(f"expected at most one sky, found {', '.join(skies)}")
        return lights

    def views(self) -> list[View]:
        """The cameras, however many."""
        return _as_list(self.camera)

    def animations(self) -> list[AnyAnimation]:
        """The animations, however many."""
        return _as_list(self.animation)

    def to_world(self) -> Float64:
        """The transform (4, 4) from the model's frame into the world's."""
        return TURNS[self.up_axis] @ np.diag([*3 * [self.metres_per_unit], 1.0])


def _as_list(value: Any) -> list[Any]:
    if value is None:
        return []
    return value if isinstance(value, list) else [value]


def read_description(path: Path) -> SceneDescription:
    """Read the description at `path`.

    Raises
    ------
    SceneError
        It is no JSON, or something in it is missing, unknown or out of its range; the first such thing is named.
    """
    if path.stat().st_size > MAX_BYTES:
        raise SceneError(f"{path}: expected at most {MAX_BYTES} bytes, found {path.stat().st_size}")
    text = path.read_bytes()
    try:
        return SceneDescription.model_validate_json(text)
    except ValidationError as error:
        raise SceneError(f"{path}: {complaint(error, text)}") from error
