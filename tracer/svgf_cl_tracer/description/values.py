"""The base class and the units of all parts of a description."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field


class Part(BaseModel):
    """An object of the file: unknown fields are errors, values are not converted, and it cannot be changed."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True, allow_inf_nan=False)


def unit(name: str) -> Any:
    """Field metadata with the unit of a number."""
    return Field(json_schema_extra={"unit": name})


NonNegative = Annotated[float, Field(ge=0)]
Share = Annotated[float, Field(ge=0, le=1)]

Vector = tuple[float, float, float]
Direction = Annotated[Vector, unit("any length")]
Position = Annotated[Vector, unit("m")]
Reflectance = Annotated[tuple[Share, Share, Share], unit("linear r, g, b")]
Radiance = Annotated[tuple[NonNegative, NonNegative, NonNegative], unit("linear r, g, b radiance")]
Index = Annotated[float, Field(ge=1)]
Seconds = Annotated[list[float], Field(min_length=1), unit("s")]
Names = Annotated[list[str], Field(min_length=1)]
