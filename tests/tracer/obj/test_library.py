from __future__ import annotations

from pathlib import Path

import pytest

from svgf_cl_tracer.obj.library import Map, read_library

UNIT, NONE = (1.0, 1.0), (0.0, 0.0)


@pytest.mark.parametrize(
    ("text", "name", "placement"),
    [
        ("red.png", "red.png", (UNIT, NONE)),
        ("my red  wall.png ", "my red  wall.png", (UNIT, NONE)),
        ("-s 2 3 1 red.png", "red.png", ((2, 3), NONE)),
        ("-s 2 red wall.png", "red wall.png", ((2, 1), NONE)),
        ("-o 0.5 -0.25 red.png", "red.png", (UNIT, (0.5, -0.25))),
        ("-S 2 2 -O 0.5 0 0 -t 0 0 0 red.png", "red.png", ((2, 2), (0.5, 0))),
        ("-blendu on -blendv off -cc off -clamp on -texres 512 -mm 0 1 -bm 0.5 red.png", "red.png", (UNIT, NONE)),
        ("-mm 0.1 2 -imfchan m -type sphere -boost 3 red.png", "red.png", (UNIT, NONE)),
        ("red wall.png -s 2 2 2", "red wall.png", ((2, 2), NONE)),
        ("-s 1 1 1 2.png", "2.png", (UNIT, NONE)),
        ("a -b.png", "a -b.png", (UNIT, NONE)),
        ("-s", "", (UNIT, NONE)),
        ("", "", (UNIT, NONE)),
    ],
)
def test_options_stand_before_or_behind_a_name_that_may_hold_spaces(
    text: str, name: str, placement: tuple[tuple[float, float], tuple[float, float]]
) -> None:
    image = Map.of(text)
    assert (image.name, image.placement()) == (name, placement)


def test_materials_by_name(tmp_path: Path) -> None:
    path = tmp_path / "a.mtl"
    path.write_text("Kd 9 9 9\nnewmtl  a  b \nKd 1 0 0\nMAP_KD x.png\nKd 0 1 0\nnewmtl c\nnewmtl a b\nKd 0 0 1\n")
    first, second = (read_library(path)[name] for name in ("a b", "c"))
    assert (first.statements["kd"].text, first.statements["kd"].line) == ("0 1 0", 5)
    assert first.maps["map_kd"].name == "x.png"
    assert second.statements == {}
