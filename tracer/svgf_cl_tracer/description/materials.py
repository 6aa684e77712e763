"""The materials of a description, named as in Mitsuba. Each is complete, except for the model's texture."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, Literal

from pydantic import Field, model_validator

from svgf_cl_tracer.errors import SceneError
from svgf_cl_tracer.materials import Material

from .values import Index, Part, Radiance, Reflectance, Share

# Opacity below which there is a hole, if the model does not define it.
CUTOFF = 0.5

Zero = Annotated[float, Field(ge=0, le=0)]
One = Annotated[float, Field(ge=1, le=1)]


class Surface(Part):
    """Fields of all materials."""

    color: Reflectance = Field(
        (1.0, 1.0, 1.0),
        description="Reflectance; of glass, transmittance. Base texture and vertex colours are multiplied by it.",
    )
    base_texture: bool = Field(False, description="Whether the model's base colour texture is used.")
    mask: bool = Field(
        False, description="Whether the surface has holes where the texture's alpha is below the model's cutoff."
    )
    twosided: bool = Field(True, description="For information: every surface except glass reflects on both sides.")
    radiance: Radiance | None = Field(
        None, description="For information: radiance of an area light with this material."
    )

    def on(self, model: Material) -> Material:
        """The material that replaces this one of the model.

        Raises
        ------
        SceneError
            If a texture or mask needs the texture of the model's material, and there is none.
        """
        if self.base_texture and model.base_texture is None:
            raise SceneError("base_texture: expected a texture in the model, found none")
        if self.mask and not (self.base_texture and model.base_texture is not None):
            raise SceneError("mask: expected a base_texture whose alpha is the mask, found none")
        return Material(
            self.color,
            base_texture=model.base_texture if self.base_texture else None,
            alpha_cutoff=(model.alpha_cutoff or CUTOFF) if self.mask else None,
        )


class Diffuse(Surface, title="diffuse"):
    """A matt surface (Lambert)."""

    type: Literal["diffuse"]
    roughness: One = Field(1.0, description="For information.")
    metallic: Zero = Field(0.0, description="For information.")


class Glossy(Surface):
    """Fields of plastic and conductor."""

    roughness: Share = Field(description="Perceptual roughness: the square root of the GGX width.")
    alpha: Share | None = Field(None, description="For information: the GGX width.")

    @model_validator(mode="after")
    def _agree(self) -> Glossy:
        if self.alpha is not None and abs(self.alpha - self.roughness**2) > 1e-3:
            raise ValueError(f"expected as alpha the square of the roughness {self.roughness}, found {self.alpha}")
        return self


class Plastic(Glossy, title="plastic"):
    """A diffuse surface under a dielectric coat."""

    type: Literal["plastic"]
    ior: Index = Field(1.5, description="Refractive index of the coat.")
    metallic: Zero = Field(0.0, description="For information.")

    def on(self, model: Material) -> Material:
        """See `Surface.on`."""
        return replace(super().on(model), roughness=self.roughness, ior=self.ior)


class Conductor(Glossy, title="conductor"):
    """A metal."""

    type: Literal["conductor"]
    metallic: One = Field(1.0, description="For information.")

    def on(self, model: Material) -> Material:
        """See `Surface.on`."""
        return replace(super().on(model), roughness=self.roughness, metallic=1.0)


class Dielectric(Surface, title="dielectric"):
    """Smooth glass. Its inside is behind the surface."""

    type: Literal["dielectric"]
    ior: Index = Field(1.5, description="Refractive index.")
    roughness: Zero = Field(0.0, description="For information.")
    alpha: Zero = Field(0.0, description="For information.")
    metallic: Zero = Field(0.0, description="For information.")
    thin: Literal[False] = Field(False, description="For information.")

    def on(self, model: Material) -> Material:
        """See `Surface.on`."""
        return replace(super().on(model), roughness=0.0, ior=self.ior, transmissive=True)


AnyMaterial = Annotated[Diffuse | Plastic | Conductor | Dielectric, Field(discriminator="type")]
