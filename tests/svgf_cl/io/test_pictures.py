"""Pictures survive the way to an EXR file and back, and lie where their file says."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from svgf_cl import FileError
from svgf_cl.io.exr import read_image, write_image
from svgf_cl.io.frames import MADE_FROM
from svgf_cl.io.pictures import channels, denoised_file, holds, is_picture, picture_file, read_picture, write_picture
from svgf_cl.io.window import Window
from tests.exr_files import exr_bytes

FLOATS = hnp.arrays(np.float32, (4, 3, 3), elements=st.floats(width=32))
PICTURE = np.arange(36, dtype=np.float32).reshape(3, 4, 3)


@given(FLOATS)
@settings(deadline=None, max_examples=20)
def test_a_picture_comes_back_bit_for_bit(picture: np.ndarray) -> None:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "out.exr"
        write_picture(path, picture)
        assert set(read_image(path).planes) == {"R", "G", "B"}
        np.testing.assert_array_equal(read_picture(path), picture, strict=True)


def test_a_picture_can_be_read_out_of_a_frame(tmp_path: Path) -> None:
    planes = {name: PICTURE[..., index] for index, name in enumerate("RGB")} | {"depth.Z": PICTURE[..., 0]}
    (tmp_path / "a.exr").write_bytes(exr_bytes(planes))
    np.testing.assert_array_equal(read_picture(tmp_path / "a.exr"), PICTURE)


def test_a_picture_is_known_bit_by_bit(tmp_path: Path) -> None:
    path, picture = tmp_path / "a.exr", np.array([[[0.0, np.nan, 1.0]]], np.float32)
    assert not is_picture(path, picture)
    write_picture(path, picture)
    assert is_picture(path, picture)
    assert not is_picture(path, -picture), "the sign of zero is a bit too"
    path.write_bytes(path.read_bytes()[:-1])
    assert not is_picture(path, picture)


def test_a_picture_is_found_by_name_and_lies_on_its_display_window(tmp_path: Path) -> None:
    planes = {f"Beauty.{name}": PICTURE[..., index] for index, name in enumerate("RGB")}
    planes["A_depth.Z"] = np.full((3, 4), 7, np.float32)
    (tmp_path / "a.exr").write_bytes(exr_bytes(planes, at=(-1, 1), display=Window(0, 0, 5, 3)))
    expected = np.zeros((3, 5, 3), np.float32)
    expected[1:, :3] = PICTURE[:2, 1:]
    np.testing.assert_array_equal(read_picture(tmp_path / "a.exr"), expected)


def test_a_file_without_a_picture_is_refused(tmp_path: Path) -> None:
    (tmp_path / "a.exr").write_bytes(exr_bytes({"depth.Z": PICTURE[..., 0]}))
    with pytest.raises(FileError, match=r"a\.exr: expected channels R G B, .*; found depth\.Z"):
        read_picture(tmp_path / "a.exr")


def test_what_a_picture_was_made_from_goes_along(tmp_path: Path) -> None:
    planes = {name: np.zeros((3, 4), np.float16) for name in "RGBA"} | {"id": np.full((3, 4), 2**32 - 1, np.uint32)}
    made_from, owner = {MADE_FROM: ("string", b"a scene")}, {"owner": ("string", b"me")}
    (tmp_path / "in.exr").write_bytes(exr_bytes(planes, made_from | owner, (1, 2), Window(0, 0, 9, 9)))
    source = read_image(tmp_path / "in.exr")
    made = channels(PICTURE)
    images = [denoised_file(made, source), denoised_file(made, source, plain=True), picture_file(PICTURE)]
    for image in images:
        write_image(tmp_path / "out.exr", image)
        assert [holds(tmp_path / "out.exr", other) for other in images] == [other is image for other in images]
    for image, names in zip(images[:2], ({*"RGBA", "id"}, {*"RGB"}), strict=True):
        write_image(tmp_path / "out.exr", image)
        written = read_image(tmp_path / "out.exr")
        assert written.planes.keys() == names
        assert written.windows == source.windows
        assert written.parts[0].attributes["owner"] == owner["owner"]
        assert MADE_FROM not in written.parts[0].attributes, "render would take it for a frame of its own"
