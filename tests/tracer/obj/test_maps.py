from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from svgf_cl_tracer import SceneError
from tests.tracer.gltf_files import png
from tests.tracer.obj.files import SQUARE, material_of, read, square_of

GREEN = np.full((2, 4, 3), (0, 255, 0), np.uint8)
MASK = np.array([[0, 255]], np.uint8)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder with images: a green one of 4 x 2, masks of 2 x 1, and one that is both."""
    (tmp_path / "green.png").write_bytes(png(GREEN))
    (tmp_path / "mask.png").write_bytes(png(MASK))
    (tmp_path / "leaf.png").write_bytes(png(np.dstack([GREEN[:1, :2], MASK])))
    (tmp_path / "solid.png").write_bytes(png(np.dstack([MASK, MASK, MASK, np.full_like(MASK, 255)])))
    return tmp_path


@pytest.mark.parametrize("mask", ["mask.png", "leaf.png", "solid.png", "-imfchan l mask.png", "-imfchan r solid.png"])
def test_map_d_cuts_holes(folder: Path, mask: str) -> None:
    material, lost = material_of(folder, f"map_Kd green.png\nmap_d {mask}")
    np.testing.assert_array_equal(material.base_texture[..., :3], GREEN)
    np.testing.assert_array_equal(material.base_texture[..., 3], [[0, 0, 255, 255]] * 2)
    assert (material.alpha_cutoff, lost) == (0.5, [])


def test_opacity_counts_twice(folder: Path) -> None:
    assert material_of(folder, "d 0.8\nmap_d mask.png")[0].alpha_cutoff == pytest.approx(0.625)


def test_holes_without_an_image(folder: Path) -> None:
    material, _ = material_of(folder, "Kd 0.5\nmap_d mask.png")
    assert material.base_colour == (0.5, 0.5, 0.5)
    np.testing.assert_array_equal(material.base_texture, [[(255, 255, 255, 0), (255, 255, 255, 255)]])


def test_holes_of_a_colour_alone_are_named(folder: Path) -> None:
    material, lost = material_of(folder, "map_Kd leaf.png")
    assert material.alpha_cutoff is None
    assert lost == ["images with holes that no map_d names, shown without holes: 'leaf.png'"]


def test_materials_share_what_is_made_of_the_same_images(folder: Path) -> None:
    library = "".join(f"newmtl {name}\nmap_Kd green.png\nmap_d mask.png\n" for name in "ab")
    model, _ = read(folder, f"mtllib a.mtl\n{SQUARE}usemtl a\nf 1/1 2/2 3/3\nusemtl b\nf 1/1 2/2 3/3\n", library)
    first, second = (item.instance.material.base_texture for item in model.objects)
    assert first is second


def test_images_are_scaled_and_shifted(folder: Path) -> None:
    instance, lost = square_of(folder, "newmtl m\nmap_Kd -s 2 4 -o 0.5 0.25 green.png\n")
    corners = np.array([(0, 0), (1, 0), (1, 1), (0, 1)])[[[0, 1, 2], [0, 2, 3]]]
    np.testing.assert_allclose(instance.uv, corners * (2, 4) + (0.5, 0.25))
    assert lost == []


@pytest.mark.parametrize(
    ("statements", "expected"),
    [
        ("map_Kd -clamp on green.png", "-clamp"),
        ("map_Kd -mm 0.1 1 -t 1 0 0 green.png", "-mm, -t"),
        ("map_Kd -s 2 2 green.png\nmap_Ke -s 2 2 green.png", None),
        ("map_Kd -s 2 2 green.png\nmap_Ke green.png", "-s or -o beside those of another image"),
        ("map_Kd -clamp off -mm 0.0 1.0 -t 0 -bm 3 -blendu off -texres 9 green.png", None),
    ],
)
def test_options_that_would_show_are_named(folder: Path, statements: str, expected: str | None) -> None:
    lost = material_of(folder, statements)[1]
    assert lost == ([f"options of images that are not read: {expected}"] if expected else [])


@pytest.mark.parametrize("name", ["green.png # a comment", "green.png# not green", "green #1.png"])
def test_a_comment_may_stand_behind_a_name_that_may_hold_its_sign(folder: Path, name: str) -> None:
    (folder / "green #1.png").write_bytes(png(GREEN))
    material, lost = material_of(folder, f"map_Kd {name}")
    np.testing.assert_array_equal(material.base_texture, GREEN)
    assert lost == []


def test_an_image_that_is_not_there_is_named(folder: Path) -> None:
    material, lost = material_of(folder, "Kd 0.5\nmap_Kd my wall.png\nmap_d ../mask.png\nmap_Ke C:\\a.png")
    assert (material.base_texture, material.alpha_cutoff, material.base_colour) == (None, None, (0.5, 0.5, 0.5))
    names = "'my wall.png', '../mask.png', 'C:\\\\a.png'"
    assert lost == [f"images that are not in its folder or below, shown without: {names}"]


def test_an_image_that_cannot_be_read_is_an_error_that_names_it(folder: Path) -> None:
    (folder / "bad.png").write_bytes((folder / "green.png").read_bytes()[:45])
    with pytest.raises(SceneError, match=r"a\.mtl: material 'm': image .*bad\.png: expected a whole image"):
        material_of(folder, "map_Kd bad.png")
