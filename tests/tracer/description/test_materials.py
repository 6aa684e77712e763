from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from pydantic import TypeAdapter

from svgf_cl_tracer import SceneError
from svgf_cl_tracer.description.materials import AnyMaterial
from svgf_cl_tracer.materials import Material

TEXTURE = np.zeros((2, 2, 4), np.uint8)
MODEL = Material((0.1, 0.2, 0.3), (1, 1, 1), TEXTURE, metallic=0.5, roughness=0.5, ior=1.5, alpha_cutoff=0.3)
COLOUR = [0.4, 0.5, 0.6]


def described(model: Material = MODEL, **fields: Any) -> Material:
    return TypeAdapter(AnyMaterial).validate_python(fields, strict=False).on(model)


def test_diffuse() -> None:
    made = described(type="diffuse", color=COLOUR)
    assert (made.base_colour, made.ior, made.metallic, made.transmissive) == (tuple(COLOUR), 1, 0, False)
    assert (made.emission, made.base_texture, made.alpha_cutoff) == ((0, 0, 0), None, None)


def test_plastic() -> None:
    made = described(type="plastic", roughness=0.2)
    assert (made.ior, made.roughness, made.metallic, made.transmissive) == (1.5, 0.2, 0, False)
    assert described(type="plastic", roughness=0.2, ior=1.3).ior == 1.3


def test_conductor() -> None:
    made = described(type="conductor", roughness=0.2, color=COLOUR)
    assert (made.base_colour, made.roughness, made.metallic, made.transmissive) == (tuple(COLOUR), 0.2, 1, False)


def test_dielectric() -> None:
    made = described(type="dielectric", ior=1.3)
    assert (made.base_colour, made.ior, made.metallic, made.transmissive) == ((1, 1, 1), 1.3, 0, True)


@pytest.mark.parametrize("kind", ["diffuse", "plastic", "conductor"])
def test_the_models_texture_stays_where_it_is_wanted(kind: str) -> None:
    fields = {"type": kind} | ({} if kind == "diffuse" else {"roughness": 0.2})
    assert described(**fields).base_texture is None
    made = described(**fields, base_texture=True)
    assert made.base_texture is TEXTURE
    assert made.alpha_cutoff is None
    assert described(**fields, base_texture=True, mask=True).alpha_cutoff == 0.3
    assert described(Material(base_texture=TEXTURE), **fields, base_texture=True, mask=True).alpha_cutoff == 0.5


def test_a_texture_that_is_not_there() -> None:
    with pytest.raises(SceneError, match="base_texture: expected a texture in the model"):
        described(Material(), type="diffuse", base_texture=True)
    with pytest.raises(SceneError, match="mask: expected a base_texture"):
        described(type="diffuse", mask=True)
