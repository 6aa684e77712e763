"""The animation of a description: nodes of the model, and all that hangs on them, carried through the world."""

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
    """What all animations have."""

    nodes: Names = Field(description="Names of nodes in the model.")
    pivot: Position = Field((0.0, 0.0, 0.0), description="The point that turns and scalings leave where it is.")
    repeats: bool = Field(False, description="Begin again after the last time, in place of standing still.")
    note: str = Field("", description="For information.")


class Rotation(Animation, title="rigid rotation"):
    """A turn about an axis of the world, from where the model has the nodes."""

    kind: Literal["rigid rotation about +X", "rigid rotation about +Y", "rigid rotation about +Z"]
    angle_deg: Turn = Field(
        description="Angles to turn through, less than 180 apart; anticlockwise seen from the axis' tip."
    )
    times_s: Seconds | None = Field(None, description="When each is reached; where absent, one a second from 0 on.")

    @model_validator(mode="after")
    def _agree(self) -> Rotation:
        if self.times_s is not None and len(self.times_s) != len(self.angle_deg):
            raise ValueError(f"expected as many times_s as angle_deg, {len(self.angle_deg)}, found {len(self.times_s)}")
        if any(abs(after - before) >= 180.0 for before, after in pairwise(self.angle_deg)):
            raise ValueError(f"expected angles less than 180 apart, found {self.angle_deg}")
        return self

    def motion(self) -> Motion:
        """What carries the nodes from where the model has them."""
        times = self.times_s or range(len(self.angle_deg))
        axis = AXES[self.kind.split()[-1]]
        return Motion.turning(self.pivot, axis, list(times), self.angle_deg, repeats=self.repeats)


class Keyframed(Animation, title="keyframes"):
    """Places, turns and sizes at keyframes, each relative to where the model has the nodes."""

    kind: Literal["keyframes"]
    times_s: Seconds = Field(description="When the keyframes are.")
    translation: Annotated[list[Vector], unit("m")] | None = Field(None, description="Way from the place in the model.")
    rotation: list[tuple[float, float, float, float]] | None = Field(
        None, description="Turn about the pivot as a quaternion x, y, z, w."
    )
    scale: list[Vector] | None = Field(None, description="Factors along the world's axes, from the pivot.")
    interpolation: Literal["linear", "step"] = Field("linear", description="How to go from one keyframe to the next.")

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
        """What carries the nodes from where the model has them."""
        step = self.interpolation == "step"
        tracks = {name: Track(self.times_s, values, step, self.repeats) for name, values in self._given().items()}
        return Motion([translation(self.pivot), Keyframes(**tracks), translation(np.negative(self.pivot))])


AnyAnimation = Annotated[Rotation | Keyframed, Field(discriminator="kind")]
