from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from svgf_cl_tracer import SceneError
from tests.tracer.obj.files import instance_of, read

POINTS = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
CORNERS = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0)])
FULL = POINTS + "vt 0 0\nvt 1 0\nvt 1 1\nvn 0 0 1\nvn 0 0 2\nvn 0 0 3\n"


@pytest.mark.parametrize(
    "face",
    [
        "f 1 2 3",
        "f -4 -3 -2",
        "F 1 2 3",
        "f\t1\t 2 3 ",
        "  f 1 2 3",
        "f 1 2 3 # a face",
        "f 1 \\\n2 \\\n 3",
        "f +1 2 3",
    ],
)
def test_ways_to_write_a_triangle(tmp_path: Path, face: str) -> None:
    np.testing.assert_array_equal(instance_of(tmp_path, POINTS + face).corners, [CORNERS])


@pytest.mark.parametrize(
    ("face", "textured", "smooth"),
    [
        ("f 1 2 3", False, False),
        ("f 1/1 2/2 3/3", True, False),
        ("f 1//1 2//2 3//3", False, True),
        ("f 1/1/1 2/2/2 3/3/3", True, True),
        ("f -4/-3/-3 -3/-2/-2 -2/-1/-1", True, True),
        ("f 1/ 2/ 3/", False, False),
        ("f 1// 2// 3//", False, False),
        ("f 1/1/ 2/2/ 3/3/", True, False),
    ],
)
def test_ways_to_write_a_corner(tmp_path: Path, face: str, textured: bool, smooth: bool) -> None:
    instance = instance_of(tmp_path, FULL + face)
    np.testing.assert_array_equal(instance.corners, [CORNERS])
    assert (instance.uv is not None, instance.normals is not None) == (textured, smooth)
    if textured:
        np.testing.assert_array_equal(instance.uv, [CORNERS[:, :2]])
    if smooth:
        np.testing.assert_array_equal(instance.normals, [[(0, 0, 1)] * 3])


def test_corners_of_all_kinds_in_one_file(tmp_path: Path) -> None:
    instance = instance_of(tmp_path, FULL + "f 1 2 3\nf 1/1 2/2 3/3\nf 1//1 2//2 3//3\nf 1/1/1 2 3//3\n")
    np.testing.assert_array_equal(instance.corners, 4 * [CORNERS])
    np.testing.assert_array_equal(np.isnan(instance.uv).any((1, 2)), False)
    np.testing.assert_array_equal(instance.normals, np.broadcast_to((0, 0, 1), (4, 3, 3)))


def test_relative_indices_count_from_where_the_face_stands(tmp_path: Path) -> None:
    text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nf -3 -2 -1\nv 5 5 5\nv 6 5 5\nv 6 6 5\nf -3 -2 -1\nf 1 2 3\n"
    np.testing.assert_array_equal(instance_of(tmp_path, text).corners, [CORNERS, CORNERS + 5, CORNERS])


def test_faces_may_stand_above_their_points(tmp_path: Path) -> None:
    np.testing.assert_array_equal(instance_of(tmp_path, "f 1 2 3\n" + POINTS).corners, [CORNERS])


@pytest.mark.parametrize(
    ("face", "complaint"),
    [
        ("f 1 2 0", "expected a number in 1..4 of a line v, .*, found 0"),
        ("f 1 2 5", "expected a number in 1..4 of a line v, .*, found 5"),
        ("f 1 2 -5", "found -5"),
        ("f 1/0 2/1 3/1", "of a line vt, .*, found 0"),
        ("f 1/9 2/1 3/1", "in 1..3 of a line vt, .*, found 9"),
        ("f 1//0 2//1 3//1", "of a line vn, .*, found 0"),
        ("f 1 2 99999999999999999999", "expected"),
        ("f 1 2 x", "expected corners such as .*, found 'x'"),
        ("f 1 2 3.5", "found '3.5'"),
        ("f 1 2 3/1/1/1", "found '3/1/1/1'"),
        ("f 1 2 /1", "found '/1'"),
        ("f 1 /1 1/1/1/1", "found '/1'"),
        ("f 1,2,3", "found '1,2,3'"),
        ("f 1/x 2 3", "found '1/x'"),
    ],
)
def test_what_is_no_corner_is_refused_with_its_line(tmp_path: Path, face: str, complaint: str) -> None:
    with pytest.raises(SceneError, match=f"line 11: .*{complaint}"):
        read(tmp_path, f"{FULL}{face}\nf 1 2 3\n")


def test_faces_of_two_corners_are_named(tmp_path: Path) -> None:
    model, lost = read(tmp_path, POINTS + "f 1 2\nf 1\nf 1 2 3\nf\n")
    assert len(model.objects[0].instance.corners) == 1
    assert lost == ["lines that are not read: f with fewer than 3 corners (3 times)"]
