from __future__ import annotations

import pytest

from svgf_cl.io.layers import in_usual_order, picture_channels


@pytest.mark.parametrize(
    ("names", "picture"),
    [
        ("A B G R", "R G B"),
        ("r g b", "r g b"),
        ("R G B Beauty.R Beauty.G Beauty.B", "R G B"),
        ("A_depth.Z Beauty.R Beauty.G Beauty.B", "Beauty.R Beauty.G Beauty.B"),
        ("albedo.R albedo.G albedo.B Some.B Some.G Some.R", "Some.R Some.G Some.B"),
        ("a.R a.G a.B ViewLayer.Combined.R ViewLayer.Combined.G ViewLayer.Combined.B",
         "ViewLayer.Combined.R ViewLayer.Combined.G ViewLayer.Combined.B"),
        ("rgba.red rgba.green rgba.blue rgba.alpha", "rgba.red rgba.green rgba.blue"),
        ("Y", "Y Y Y"),
        ("Y A", "Y Y Y"),
        ("Y Z", "Y Y Y"),
    ],
)  # fmt: skip
def test_the_picture_is_found_by_name(names: str, picture: str) -> None:
    for order in (names.split(), names.split()[::-1]):
        assert picture_channels(order) == tuple(picture.split())


@pytest.mark.parametrize(
    "names",
    [
        "R G",
        "X Y Z",
        "Y RY BY",
        "depth.Z normal.X normal.Y normal.Z",
        "albedo.R albedo.G albedo.B",
        "a.R a.G a.B b.R b.G b.B",
        "beauty.R beauty.G beauty.B rgba.R rgba.G rgba.B",
    ],
)
def test_no_picture_or_several_are_refused_with_what_was_found(names: str) -> None:
    with pytest.raises(ValueError, match=f"expected channels R G B, .*; found {names}$"):
        picture_channels(names.split())


def test_channels_are_named_as_people_do() -> None:
    names = ["R", "G", "B", "A", "Z", "id", "a.R", "a.G", "a.X", "a.Y", "a.u", "n.X", "n.Y", "n.Z"]
    assert in_usual_order(sorted(names)) == names
