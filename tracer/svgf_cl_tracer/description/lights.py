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

# Two triangles of a rectangle: how far along either edge each corner lies.
SQUARE = np.array([[[0, 0], [1, 0], [1, 1]], [[0, 0], [1, 1], [0, 1]]], np.float64)


class SunLight(Part, title="sun"):
    """A disc of light at infinity."""

    type: Literal["sun"]
    direction_to_light: Direction = Field(description="From the scene towards the middle of the disc.")
    irradiance: Irradiance = Field(description="On a plane that faces the disc.")
    angular_radius_deg: Annotated[float, Field(ge=0, lt=90), unit("degrees")] = Field(
        0.25, description="Half the angle under which the disc is seen; at 0 it is not seen, but it lights."
    )

    def light(self) -> Sun:
        """The tracer's own."""
        return Sun(self.direction_to_light, self.irradiance, self.angular_radius_deg)


class ConstantSky(Part, title="sky_constant"):
    """The same light from everywhere outside the scene."""

    type: Literal["sky_constant"]
    radiance: Radiance = Field(description="Of the sky.")


class EnvironmentMap(Part, title="envmap"):
    """An image of all that is outside the scene, in equirectangular projection."""

    type: Literal["envmap"]
    file: str = Field(description="A .hdr or .exr image in the description's folder.")
    to_world_rows: tuple[Vector, Vector, Vector] = Field(
        ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)),
        description=(
            "Rotation from the image's frame into the world's, row by row. In the image's frame the middle column is "
            "towards +z, the column a quarter of the width from the left towards +x, and row 0 is up, +y: as in "
            "OpenEXR and Mitsuba."
        ),
    )
    note: str = Field("", description="For information.")


class AreaLight(Part, title="area"):
    """A material of the model that emits light from its front, the side from which corners run counter-clockwise."""

    type: Literal["area"]
    material: str = Field(description="Its name in the model.")
    radiance: Radiance = Field(description="What it emits.")
    mesh: str = Field("", description="For information: where the material is.")


class Rectangle(Part, title="rect"):
    """A black rectangle that emits light to the side of edge_u x edge_v."""

    type: Literal["rect"]
    name: str = Field("", description="For information.")
    corner: Position = Field(description="One of its corners.")
    edge_u: Position = Field(description="From there to the next corner.")
    edge_v: Position = Field(description="From there to the other next corner.")
    radiance: Radiance = Field(description="What it emits.")

    def instance(self) -> Instance:
        """The tracer's own."""
        corners = np.array(self.corner) + SQUARE[..., :1] * self.edge_u + SQUARE[..., 1:] * self.edge_v
        return Instance(corners, Material((0.0, 0.0, 0.0), self.radiance))


AnyLight = Annotated[
    SunLight | ConstantSky | EnvironmentMap | AreaLight | Rectangle,
    Field(discriminator="type"),
]
