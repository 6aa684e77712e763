"""Options that say how frames are to be read."""

from __future__ import annotations

from pathlib import Path

import pytest

from svgf_cl.cli.reading import parse_maps, read_as
from svgf_cl.errors import SvgfError
from tests.renderers import cameras_file


def test_maps_are_read_one_by_one_or_together() -> None:
    expected = {"depth": "Z", "normal": "World Normal", "id": "a.b"}
    assert parse_maps(["depth=Z, normal = World Normal", "id=a.b"]) == expected
    assert parse_maps([]) == {}
    assert parse_maps(["color=a=b"]) == {"color": "a=b"}


@pytest.mark.parametrize("text", ["depth", "depth=", "depth=Z,", "", "depth:Z"])
def test_a_map_without_a_pass_is_refused(text: str) -> None:
    with pytest.raises(SvgfError, match="--map: expected FIELD=PASS such as depth=Z, got"):
        parse_maps([text])


@pytest.mark.parametrize(
    ("flip", "scale", "expected"),
    [("", 1.0, (1, 1)), ("y", 1.0, (1, -1)), ("x", 2.0, (-2, 2)), ("xy", 0.5, (-0.5, -0.5))],
)
def test_motion_is_scaled_and_flipped(flip: str, scale: float, expected: tuple[float, float]) -> None:
    assert read_as(motion_flip=flip, motion_scale=scale).motion_scale == expected


@pytest.mark.parametrize("flip", ["z", "yx", "Y", "x,y", "-"])
def test_an_axis_that_is_none_is_refused(flip: str) -> None:
    with pytest.raises(SvgfError, match="--motion-flip: expected x, y or xy, got"):
        read_as(motion_flip=flip)


@pytest.mark.parametrize("scale", [0.0, -1.0, float("nan"), float("inf")])
def test_a_scale_that_is_none_is_refused(scale: float) -> None:
    with pytest.raises(SvgfError, match="--motion-scale: expected a number above 0, got"):
        read_as(motion_scale=scale)


def test_a_field_that_is_none_is_refused_before_a_file_is_read() -> None:
    with pytest.raises(SvgfError, match=r"--map: expected one of color, .*motion_to_next, got 'z'"):
        read_as(maps=["z=Z"])


def test_a_file_of_cameras_must_be_there(tmp_path: Path) -> None:
    path = cameras_file(tmp_path, (3, 4))
    assert read_as(cameras=path).cameras == path
    with pytest.raises(SvgfError, match="nowhere"):
        read_as(cameras=tmp_path / "nowhere.json")
