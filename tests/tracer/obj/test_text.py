from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from svgf_cl_tracer import SceneError
from svgf_cl_tracer.obj.text import by_keyword, read_text
from tests.tracer.obj.files import instance_of, read

TRIANGLE = "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n"


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "latin-1", "cp1252"])
@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_encodings_and_ends_of_lines(tmp_path: Path, encoding: str, end: str) -> None:
    model, _ = read(tmp_path, f"o Tür\n{TRIANGLE}".replace("\n", end).encode(encoding))
    assert model.objects[0].nodes == ("a.obj", "Tür")
    assert len(model.objects[0].instance.corners) == 1


def test_the_last_line_needs_no_end(tmp_path: Path) -> None:
    assert len(instance_of(tmp_path, TRIANGLE.rstrip()).corners) == 1


def test_numbers_of_lines_count_those_that_are_joined(tmp_path: Path) -> None:
    (tmp_path / "a").write_text("v 1 \\\n 2 \\\n 3\n\n# \\\n v\nv 4 5 6\\")
    lines = by_keyword(read_text(tmp_path / "a"))
    assert (lines["v"].numbers, [text.split() for text in lines["v"].texts]) == (
        [1, 7],
        [["1", "2", "3"], ["4", "5", "6"]],
    )


@pytest.mark.parametrize(
    ("line", "complaint"),
    [
        ("v 1 2", "expected 3 finite numbers, found"),
        ("v 1 2 x", "expected numbers, found 'x'"),
        ("v 1,5 2 3", "expected numbers, found '1,5'"),
        ("v 1-2 3 4", "expected numbers, found '1-2'"),
        ("v 1-2 x", "expected numbers, found '1-2'"),
        ("v nan 0 0", "expected 3 finite numbers, found"),
        ("v 1e999 0 0", "expected 3 finite numbers, found"),
        ("vt", "expected 1 finite numbers, found"),
        ("vt inf 0", "expected 1 finite numbers, found"),
        ("vn 0 1", "expected 3 numbers, found"),
    ],
)
def test_what_is_no_number_is_refused_with_its_line(tmp_path: Path, line: str, complaint: str) -> None:
    with pytest.raises(SceneError, match=f"line 2: {complaint}"):
        read(tmp_path, f"# first\n{line}\n{TRIANGLE}")


def test_points_may_have_weights_and_comments(tmp_path: Path) -> None:
    text = "v 0 0 0 1 # origin\nv 1e0 .0 -0.\t# x\n  v\t+1 1. 0 1.0\nf 1 2 3#\n"
    np.testing.assert_array_equal(instance_of(tmp_path, text).corners, [[(0, 0, 0), (1, 0, 0), (1, 1, 0)]])


def test_no_text_is_refused(tmp_path: Path) -> None:
    with pytest.raises(SceneError, match="expected a text, found zeros"):
        read(tmp_path, b"v 0 0\0 0\n")
