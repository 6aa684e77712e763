"""The animations of a description: motion of nodes of the model and of the nodes below them."""

from __future__ import annotations

from itertools import pairwise
from typing import Annotated, Literal

import numpy as np
from pydantic import Field, model_validator

from svgf_cl_tracer.motion import Keyframes, Motion, Track, translation

from .values import Names, Part, Position, Seconds, Vector, unit

AXES = {"+X": (1.0, 0.0, 0.0), "+Y": (0.0, 1.0, 0.0), "+Z": (0.0, 0.0, 1.0)}
Turn = Annotated[list[float], Field(min_length=1), unit("degrees")]


class Animation(Part):
    """Fields of all animations."""

    nodes: Names = Field(description="Names of the nodes that move.")
    pivot: Position = Field((0.0, 0.0, 0.0), description="The point that stays in place in rotations and scalings.")
    repeats: bool = Field(
        False, description="If true, the motion starts again after the last time; otherwise the nodes stop."
    )
    note: str = Field("", description="For information.")


class Rotation(Animation, title="rigid rotation"):
    """A rotation about an axis of the world, relative to the position in the model."""

    kind: Literal["rigid rotation about +X", "rigid rotation about +Y", "rigid rotation about +Z"]
    angle_deg: Turn = Field(
        description="Angles, each less than 180 from the one before; positive is anticlockwise, seen from +axis."
    )
    times_s: Seconds | None = Field(None, description="Time of each angle. Default: 0, 1, 2 and so on.")

    @model_validator(mode="after")
    def _agree(self) -> Rotation:
        if self.times_s is not None and len(self.times_s) != len(self.angle_deg):
            raise ValueError(f"expected as many times_s as angle_deg, {len(self.angle_deg)}, found {len(self.times_s)}")
        if any(abs(after - before) >= 180.0 for before, after in pairwise(self.angle_deg)):
            raise ValueError(f"expected angles less than 180 apart, found {self.angle_deg}")
        return self

    def motion(self) -> Motion:
        """The motion that moves the nodes from their position in the model."""
        times = self.times_s or range(len(self.angle_deg))
        axis = AXES[self.kind.split()[-1]]
        return Motion.turning(self.pivot, axis, list(times), self.angle_deg, repeats=self.repeats)


class Keyframed(Animation, title="keyframes"):
    """Translations, rotations and scales at keyframes, relative to the position in the model."""

    kind: Literal["keyframes"]
    times_s: Seconds = Field(description="Times of the keyframes.")
    translation: Annotated[list[Vector], unit("m")] | None = Field(
        None, description="Offset from the position in the model."
    )
    rotation: list[tuple[float, float, float, float]] | None = Field(
        None, description="Rotation about the pivot as a quaternion x, y, z, w."
    )
    scale: list[Vector] | None = Field(None, description="Factors along the world's axes, from the pivot.")
    interpolation: Literal["linear", "step"] = Field("linear", description="How values change between keyframes.")

    @model_validator(mode="after")
    def _agree(self) -> Keyframed:
        for name, values in self._given().items():
            if len(values) != len(self.times_s):
                raise ValueError(
                    f"expected as many values of {name} as times_s, {len(self.times_s)}, found {len(values)}"
                )
        if not all(map(any, self.rotation or [])):
            raise ValueError("expected quaternions of a length above 0 as rotation, found one of 0")
        if not self._given():
            raise ValueError("expected a translation, a rotation or a scale, found none")
        return self

    def _given(self) -> dict[str, list[Vector] | list[tuple[float, float, float, float]]]:
        values = {"translation": self.translation, "rotation": self.rotation, "scale": self.scale}
        return {name: value for name, value in values.items() if value is not None}

    def motion(self) -> Motion:
        """The motion that moves the nodes from their position in the model."""
        step = self.interpolation == "step"
        tracks = {name: Track(self.times_s, values, step, self.repeats) for name, values in self._given().items()}
        return Motion([translation(self.pivot), Keyframes(**tracks), translation(np.negative(self.pivot))])


AnyAnimation = Annotated[Rotation | Keyframed, Field(discriminator="kind")]
