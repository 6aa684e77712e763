from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from svgf_cl_tracer import SceneError
from svgf_cl_tracer.materials import Material
from tests.tracer.gltf_files import png
from tests.tracer.obj.files import SQUARE, material_of, read, square_of

RED = np.full((2, 2, 3), (255, 0, 0), np.uint8)
UNREAD = "parts of materials that are not read"


@pytest.mark.parametrize(
    ("statements", "colour", "emission"),
    [
        ("", Material.base_colour, (0, 0, 0)),
        ("Kd 0.5 1 0.25\nKe 2 3 4", (0.5, 1, 0.25), (2, 3, 4)),
        ("\tkd\t0.5 # grey\n Ke 2", (0.5, 0.5, 0.5), (2, 2, 2)),
        (
            "Ka 1 1 1\nNs 10\nNi 1.5\nKs 0 0 0\nillum 2\nd 1\nTr 0\nTf 1 1 1\nsharpness 60",
            Material.base_colour,
            (0, 0, 0),
        ),
    ],
)
def test_colours(tmp_path: Path, statements: str, colour: tuple, emission: tuple) -> None:
    material, lost = material_of(tmp_path, statements)
    assert (material.base_colour, material.emission, lost) == (colour, emission, [])
    assert (material.ior, material.metallic, material.roughness) == (1.0, 0.0, 1.0)


@pytest.mark.parametrize(
    ("statements", "complaint"),
    [
        ("Kd 1 1", "line 2: Kd: expected numbers, 1 or 3, found 2"),
        ("Kd", "line 2: Kd: expected numbers, 1 or 3, found 0"),
        ("\nKd red", "line 3: expected numbers, found 'red'"),
        ("Kd 255 0 0", r"expected a colour in 0\.\.1, got"),
        ("Kd nan", r"expected a colour in 0\.\.1, got"),
        ("Ke -1", "expected a finite emission"),
        ("Pr 2", r"expected roughness in 0\.\.1"),
        ("d x", "line 2: expected numbers, found 'x'"),
    ],
)
def test_what_makes_no_sense_is_refused_with_its_place(tmp_path: Path, statements: str, complaint: str) -> None:
    with pytest.raises(SceneError, match=f"a.mtl: material 'm': .*{complaint}"):
        material_of(tmp_path, statements)


@pytest.mark.parametrize(
    ("statements", "expected"),
    [
        ("Ks 0.5\nNs 10\nillum 2", [f"{UNREAD}: Ks"]),
        ("Ks 1 1 1\nmap_Bump -bm 0.5 a.png\nbump b.png\nnorm n.png", [f"{UNREAD}: Ks, map_Bump, bump, norm"]),
        ("illum 7\nTf 0.9 1 1", [f"{UNREAD}: illum, Tf"]),
        ("Kd spectral a.rfl 1", [f"{UNREAD}: Kd spectral"]),
        ("Ke xyz 0.5 0.5 0.5", [f"{UNREAD}: Ke xyz"]),
        ("d -halo 0.7", [f"{UNREAD}: d"]),
        ("Pc 0\naniso 0", []),
        ("Pc 0.5", [f"{UNREAD}: Pc"]),
        ("colour 1 0 0", [f"{UNREAD}: colour"]),
    ],
)
def test_what_is_not_read_is_named_if_it_would_show(tmp_path: Path, statements: str, expected: list[str]) -> None:
    assert material_of(tmp_path, statements)[1] == expected


def test_a_loss_is_named_once_for_all_materials(tmp_path: Path) -> None:
    names = [f"m{number}" for number in range(20)]
    text = "mtllib a.mtl\n" + SQUARE + "".join(f"usemtl {name}\nf 1 2 3\n" for name in (*names, *names[:3]))
    library = "".join(f"newmtl {name}\nKs 1 1 1\nmap_Kd {name}.png\n" for name in names)
    model, lost = read(tmp_path, text, library)
    assert [item.material for item in model.objects] == names
    assert lost == [
        f"{UNREAD}: Ks (20 times)",
        "images that are not in its folder or below, shown without: "
        + ", ".join(f"'m{number}.png'" for number in range(8))
        + ", 12 more",
    ]


@pytest.mark.parametrize(
    ("statement", "seen"), [("d 0.4", False), ("d 0.5", True), ("Tr 0.6", False), ("Tr 0.5", True)]
)
def test_what_is_half_transparent_is_not_seen(tmp_path: Path, statement: str, seen: bool) -> None:
    text = f"mtllib a.mtl\n{SQUARE}usemtl m\nf 1 2 3\n"
    model, lost = read(tmp_path, text, f"newmtl m\n{statement}\n")
    assert len(model.objects) == seen
    assert lost == ([] if seen else ["materials with an opacity (d, Tr) below one half, not shown: 'm'"])


def test_d_counts_where_tr_says_otherwise(tmp_path: Path) -> None:
    assert material_of(tmp_path, "Tr 1\nd 1")[1] == []


def test_roughness_and_metalness(tmp_path: Path) -> None:
    material, lost = material_of(tmp_path, "Pr 0.25\nPm 1\n")
    assert (material.roughness, material.metallic, material.ior, lost) == (0.25, 1.0, 1.5, [])
    (tmp_path / "half.png").write_bytes(png(np.full((2, 2), 102)))
    material, lost = material_of(tmp_path, "Pr 0.5\nmap_Pr half.png\nmap_Pm half.png\n")
    assert (material.roughness, material.metallic, lost) == (pytest.approx(0.2), pytest.approx(0.4), [])


def test_an_image_makes_a_missing_colour_white(tmp_path: Path) -> None:
    (tmp_path / "red.png").write_bytes(png(RED))
    material, _ = material_of(tmp_path, "map_Kd red.png\nmap_Ke red.png")
    assert (material.base_colour, material.emission) == ((1, 1, 1), (1, 1, 1))
    assert material.base_texture is material.emission_texture
    np.testing.assert_array_equal(material.base_texture, RED)


def test_images_without_texture_coordinates_are_named(tmp_path: Path) -> None:
    (tmp_path / "red.png").write_bytes(png(RED))
    _, lost = read(tmp_path, f"mtllib a.mtl\n{SQUARE}usemtl m\nf 1 2 3\n", "newmtl m\nmap_Kd red.png\n")
    assert lost == [
        "materials with an image on faces without texture coordinates (vt), which show one texel of it: 'm'"
    ]


@pytest.mark.parametrize("name", ["", "mtllib b.mtl\n"])
def test_a_material_that_is_nowhere_is_grey_and_named(tmp_path: Path, name: str) -> None:
    model, lost = read(tmp_path, f"{name}{SQUARE}usemtl wood\nf 1 2 3\n", "newmtl m\n")
    (item,) = model.objects
    assert (item.material, item.instance.material.base_colour) == ("wood", Material.base_colour)
    expected = ["material libraries that are not in its folder or below: 'b.mtl'"] if name else []
    assert lost == [*expected, "materials that no library defines, shown in a plain colour: 'wood'"]


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16", "latin-1"])
def test_libraries_have_any_encoding(tmp_path: Path, encoding: str) -> None:
    (tmp_path / "Tür.png").write_bytes(png(RED))
    instance, lost = square_of(tmp_path, "newmtl m\r\nmap_Kd Tür.png\r\n".encode(encoding))
    assert instance.material.base_texture is not None
    assert lost == []
