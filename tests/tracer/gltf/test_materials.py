from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from svgf_cl_tracer import SceneError
from svgf_cl_tracer.gltf.file import Gltf
from svgf_cl_tracer.gltf.materials import Materials
from svgf_cl_tracer.materials import Material
from tests.tracer.gltf_files import png, uri, write_gltf

RGBA = np.array([[(255, 0, 0, 255), (0, 255, 0, 0)], [(0, 0, 255, 128), (255, 255, 255, 255)]], np.uint8)
TEXTURE = {"baseColorTexture": {"index": 0}}


def read(folder: Path, material: dict[str, Any], image: bytes | None = None) -> Material | None:
    images = [{"uri": uri(png(RGBA) if image is None else image, "image/png")}]
    path = write_gltf(folder / "a.gltf", materials=[material], textures=[{"source": 0}], images=images)
    name, made = Materials(Gltf.read(path)).of(0)
    assert name == material.get("name", "")
    return made


def extensions(**values: Any) -> dict[str, Any]:
    return {"extensions": {f"KHR_materials_{name}": value for name, value in values.items()}}


def reflectance(material: Material) -> float:
    return ((material.ior - 1) / (material.ior + 1)) ** 2


def test_what_a_file_leaves_out_is_as_the_specification_has_it(tmp_path: Path) -> None:
    material = read(tmp_path, {"name": "plain"})
    assert (material.base_colour, material.metallic, material.roughness) == ((1, 1, 1), 1, 1)
    assert material.ior == pytest.approx(1.5)
    assert (material.alpha_cutoff, material.transmissive, material.base_texture) == (None, False, None)


def test_factors_are_not_rounded_to_8_bits(tmp_path: Path) -> None:
    base = {"baseColorFactor": [0.0123, 0.4567, 0.8912, 1], "metallicFactor": 0.1234, "roughnessFactor": 0.5678}
    material = read(tmp_path, {"pbrMetallicRoughness": base})
    assert material.base_colour == (0.0123, 0.4567, 0.8912)
    assert (material.metallic, material.roughness) == (0.1234, 0.5678)


def test_a_texture_of_gloss_counts_with_its_mean(tmp_path: Path) -> None:
    base = {"metallicRoughnessTexture": {"index": 0}, "roughnessFactor": 0.5}
    image = png([[(9, 0, 255), (9, 102, 0)]])
    material = read(tmp_path, {"pbrMetallicRoughness": base}, image)
    assert material.roughness == pytest.approx(0.5 * 0.2)
    assert material.metallic == pytest.approx(0.5)


@pytest.mark.parametrize(
    ("values", "expected"),
    [
        ({"ior": {"ior": 1.33}}, (0.33 / 2.33) ** 2),
        ({"ior": {"ior": 1.0}}, 0.0),
        ({"specular": {"specularFactor": 0.0}}, 0.0),
        ({"specular": {"specularColorFactor": [0, 0, 0]}, "ior": {"ior": 1000}}, 0.0),
        ({"specular": {"specularFactor": 0.25}}, 0.01),
        ({"specular": {"specularColorFactor": [0.5, 0.5, 0.5]}}, 0.02),
        ({"specular": None, "ior": None}, 0.04),
        ({"ior": {"ior": 0}, "specular": {"specularColorFactor": [0.5, 0.5, 0.5]}}, 0.5),
        ({"ior": {"ior": 0}}, 0.98),  # a mirror, nearly
    ],
)
def test_reflectance_of_the_coat(tmp_path: Path, values: dict[str, Any], expected: float) -> None:
    assert reflectance(read(tmp_path, extensions(**values))) == pytest.approx(expected)


def test_glass_is_transmissive_with_its_own_index(tmp_path: Path) -> None:
    glass = extensions(transmission={"transmissionFactor": 1.0}, ior={"ior": 1.31})
    material = read(tmp_path, glass)
    assert (material.transmissive, material.ior) == (True, 1.31)


def test_emission_has_its_strength(tmp_path: Path) -> None:
    lamp = {"emissiveFactor": [1.0, 0.5, 0.25], "emissiveTexture": {"index": 0}}
    material = read(tmp_path, lamp | extensions(emissive_strength={"emissiveStrength": 8.0}))
    assert material.emission == (8, 4, 2)
    np.testing.assert_array_equal(material.emission_texture, RGBA)


@pytest.mark.parametrize(
    ("mode", "expected"), [({"alphaMode": "MASK"}, 0.5), ({"alphaMode": "MASK", "alphaCutoff": 0.3}, 0.3)]
)
def test_a_mask_keeps_the_alpha_of_its_texture(tmp_path: Path, mode: dict[str, Any], expected: float) -> None:
    material = read(tmp_path, {"pbrMetallicRoughness": TEXTURE} | mode)
    np.testing.assert_array_equal(material.base_texture, RGBA)
    assert material.alpha_cutoff == pytest.approx(expected)


def test_a_factor_of_opacity_raises_the_cutoff(tmp_path: Path) -> None:
    base = TEXTURE | {"baseColorFactor": [1, 1, 1, 0.8]}
    material = read(tmp_path, {"pbrMetallicRoughness": base, "alphaMode": "MASK", "alphaCutoff": 0.4})
    assert material.alpha_cutoff == pytest.approx(0.5)


def test_what_is_blended_is_cut_out_at_one_half(tmp_path: Path) -> None:
    material = read(tmp_path, {"pbrMetallicRoughness": TEXTURE, "alphaMode": "BLEND", "alphaCutoff": 0.1})
    assert material.alpha_cutoff == pytest.approx(0.5)


def test_the_alpha_of_an_opaque_material_is_no_matter(tmp_path: Path) -> None:
    base = TEXTURE | {"baseColorFactor": [1, 1, 1, 0]}
    material = read(tmp_path, {"pbrMetallicRoughness": base})
    np.testing.assert_array_equal(material.base_texture, RGBA)
    assert material.alpha_cutoff is None


def test_a_cutoff_of_0_leaves_all_solid(tmp_path: Path) -> None:
    """Even what is not opaque at all."""
    base = TEXTURE | {"baseColorFactor": [1, 1, 1, 0]}
    material = read(tmp_path, {"pbrMetallicRoughness": base, "alphaMode": "MASK", "alphaCutoff": 0})
    assert material.alpha_cutoff is None


def test_a_primitive_without_a_material_is_grey_or_has_its_own_colours(tmp_path: Path) -> None:
    materials = Materials(Gltf.read(write_gltf(tmp_path / "a.gltf")))
    assert materials.of(None)[1].base_colour == (0.8, 0.8, 0.8)
    assert materials.of(None, coloured=True)[1].base_colour == (1, 1, 1)


@pytest.mark.parametrize("base", [{}, TEXTURE])
def test_what_is_thinner_than_its_cutoff_cannot_be_seen(tmp_path: Path, base: dict[str, Any]) -> None:
    pane = {"pbrMetallicRoughness": base | {"baseColorFactor": [1, 1, 1, 0.3]}, "alphaMode": "BLEND"}
    assert read(tmp_path, pane) is None


@pytest.mark.parametrize("name", ["baseColorTexture", "emissiveTexture"])
def test_an_unreadable_texture_is_named(tmp_path: Path, name: str) -> None:
    texture = {name: {"index": 0}}
    material = {"name": "brick"} | (texture if name == "emissiveTexture" else {"pbrMetallicRoughness": texture})
    with pytest.raises(SceneError, match=f"{name} of material 'brick' cannot be read"):
        read(tmp_path, material, b"no png")


def test_images_are_unpacked_once(tmp_path: Path) -> None:
    material = {"pbrMetallicRoughness": TEXTURE, "emissiveTexture": {"index": 0}}
    made = read(tmp_path, material)
    assert made.base_texture is made.emission_texture
