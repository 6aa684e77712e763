"""Read and check a scene.json; an error is one line that says what is wrong."""

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

# From the model's frame to the world's, in which +y is up: a rotation about +x.
TURNS = {"y": np.eye(4), "z": np.array([[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]], np.float64)}


class SceneDescription(Part, title="Scene"):
    """A model, and what its file does not contain. Positions are in world space, in metres, with +y up."""

    model: str = Field(description="A .glb, .gltf or .obj file in the folder of scene.json.")
    up_axis: Literal["y", "z"] = Field("y", description="The axis of the model that points up.")
    metres_per_unit: Annotated[float, Field(gt=0), unit("m")] = Field(1.0, description="The model's unit of length.")
    camera: View | list[View] | None = Field(
        None,
        description="One, or several that it passes at equal intervals. Default: the model's, or one that sees all.",
    )
    lights: list[AnyLight] = Field(
        [], description="Lights in addition to those of the model; at most one of them is a sky."
    )
    alternative_lights: list[AnyLight] = Field(
        [], description="With `--alternative-lights`, these are used instead of `lights`."
    )
    materials: dict[str, AnyMaterial] = Field(
        {}, description="They replace the model's materials of the same names, including their emission."
    )
    animation: AnyAnimation | list[AnyAnimation] | None = Field(
        None,
        description="One motion or several. If several move the same node, each is applied on top of those before it.",
    )
    units: str = Field("", description="For information.")
    dropped: str = Field("", description="For information: what was lost when the model was converted from its source.")

    @field_validator("lights", "alternative_lights")
    @classmethod
    def _one_sky(cls, lights: list[AnyLight]) -> list[AnyLight]:
        skies = [light.type for light in lights if isinstance(light, ConstantSky | EnvironmentMap)]
        if len(skies) > 1:
            raise ValueError(f"expected at most one sky, found {', '.join(skies)}")
        return lights

    def views(self) -> list[View]:
        """The cameras: none, one or several."""
        return _as_list(self.camera)

    def animations(self) -> list[AnyAnimation]:
        """The animations: none, one or several."""
        return _as_list(self.animation)

    def to_world(self) -> Float64:
        """The transform (4, 4) from the model's frame into the world."""
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
        If it is not JSON, or a field is missing, unknown or out of range; the error names the first such field.
    """
    if path.stat().st_size > MAX_BYTES:
        raise SceneError(f"{path}: expected at most {MAX_BYTES} bytes, found {path.stat().st_size}")
    text = path.read_bytes()
    try:
        return SceneDescription.model_validate_json(text)
    except ValidationError as error:
        raise SceneError(f"{path}: {complaint(error, text)}") from error
