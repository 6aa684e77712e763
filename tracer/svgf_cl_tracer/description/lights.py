"""The lights of a description."""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from svgf_cl_tracer.geometry import Instance
from svgf_cl_tracer.lights import Sun
from svgf_cl_tracer.materials import Material

from .values import Direction, NonNegative, Part, Position, Radiance, Vector, unit

Irradiance = Annotated[tuple[NonNegative, NonNegative, NonNegative], unit("linear r, g, b irradiance")]

# The corners of a rectangle's two triangles, as shares of both edges.
SQUARE = np.array([[[0, 0], [1, 0], [1, 1]], [[0, 0], [1, 1], [0, 1]]], np.float64)


class SunLight(Part, title="sun"):
    """A disc of light at infinity."""

    type: Literal["sun"]
    direction_to_light: Direction = Field(description="Direction from the scene to the centre of the disc.")
    irradiance: Irradiance = Field(description="Irradiance on a plane that faces the disc.")
    angular_radius_deg: Annotated[float, Field(ge=0, lt=90), unit("degrees")] = Field(
        0.25, description="Half the angle of the disc as seen from the scene. At 0 it is invisible, but gives light."
    )

    def light(self) -> Sun:
        """The light as the tracer's own class."""
        return Sun(self.direction_to_light, self.irradiance, self.angular_radius_deg)


class ConstantSky(Part, title="sky_constant"):
    """A sky that has the same radiance in all directions."""

    type: Literal["sky_constant"]
    radiance: Radiance = Field(description="Radiance of the sky.")


class EnvironmentMap(Part, title="envmap"):
    """An image of the surroundings in all directions, in equirectangular projection."""

    type: Literal["envmap"]
    file: str = Field(description="A .hdr or .exr image in the folder of scene.json.")
    to_world_rows: tuple[Vector, Vector, Vector] = Field(
        ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)),
        description=(
            "Rotation from image space to world space, as a list of rows. In image space the middle column is at +z, "
            "the column at a quarter of the width from the left is at +x, and row 0 is at the top, +y, as in OpenEXR "
            "and Mitsuba."
        ),
    )
    note: str = Field("", description="For information.")


class AreaLight(Part, title="area"):
    """A material of the model that emits light from its front: the side where corners are counter-clockwise."""

    type: Literal["area"]
    material: str = Field(description="The name of the material in the model.")
    radiance: Radiance = Field(description="Radiance that it emits.")
    mesh: str = Field("", description="For information: the mesh that has the material.")


class Rectangle(Part, title="rect"):
    """A black rectangle that emits light on the side to which edge_u x edge_v (the cross product) points."""

    type: Literal["rect"]
    name: str = Field("", description="For information.")
    corner: Position = Field(description="One corner.")
    edge_u: Position = Field(description="Vector from `corner` to one neighbouring corner.")
    edge_v: Position = Field(description="Vector from `corner` to the other neighbouring corner.")
    radiance: Radiance = Field(description="Radiance that it emits.")

    def instance(self) -> Instance:
        """The light as the tracer's own class."""
        corners = np.array(self.corner) + SQUARE[..., :1] * self.edge_u + SQUARE[..., 1:] * self.edge_v
        return Instance(corners, Material((0.0, 0.0, 0.0), self.radiance))


AnyLight = Annotated[
    SunLight | ConstantSky | EnvironmentMap | AreaLight | Rectangle,
    Field(discriminator="type"),
]
