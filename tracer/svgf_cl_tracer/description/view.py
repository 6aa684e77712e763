"""The camera of a description."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from svgf_cl_tracer.camera import Camera

from .values import Direction, NonNegative, Part, Position, Share, unit


class View(Part, title="Camera"):
    """A perspective camera."""

    position: Position = Field(description="Position of the camera.")
    look_at: Position = Field(description="A point in the middle of the picture; the camera focuses on it.")
    up: Direction = Field((0.0, 1.0, 0.0), description="The direction that points up in the picture.")
    fov_y_deg: Annotated[float, Field(gt=0, lt=180), unit("degrees")] = Field(
        45.0, description="Vertical field of view."
    )
    aperture: Annotated[NonNegative, unit("m")] = Field(
        0.0, description="Diameter of the lens. At 0 everything is sharp."
    )
    shutter: Share = Field(
        0.0, description="How long the shutter is open, as a fraction of the time between two frames."
    )
    source_width: int = Field(0, ge=0, description="For information: size of the picture that the scene's author made.")
    source_height: int = Field(
        0, ge=0, description="For information: size of the picture that the scene's author made."
    )

    def camera(self) -> Camera:
        """The camera as the tracer's own class."""
        return Camera(self.position, self.look_at, self.up, self.fov_y_deg, self.aperture, self.shutter)
