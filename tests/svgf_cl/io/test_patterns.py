"""Names of numbered files, and ranges of numbers."""

from __future__ import annotations

import tempfile
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from svgf_cl import FileError
from svgf_cl.errors import SvgfError
from svgf_cl.io.patterns import expanded, has_number, numbered, parse_range
from svgf_cl.io.sequence import find_frames

NAMES = ["a.0001.exr", "a.0002.exr", "a.10000.exr", "a.0001.png", "b.0001.exr", "a.exr", "xa.0001.exr", ".a.0003.exr"]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name in NAMES:
        (tmp_path / name).touch()
    return tmp_path


@pytest.mark.parametrize("pattern", ["a.####.exr", "a.#.exr", "a.%04d.exr", "a.%d.exr", "a.*.exr", "a.[0-9]*.exr"])
def test_a_pattern_stands_for_its_files(pattern: str, folder: Path) -> None:
    assert [path.name for path in expanded(folder / pattern)] == ["a.0001.exr", "a.0002.exr", "a.10000.exr"]


@pytest.mark.parametrize("name", ["a.exr", "nowhere.exr", "a.%x.exr", "a.%4d.exr"])
def test_a_name_without_a_pattern_stands_for_itself(name: str, folder: Path) -> None:
    assert expanded(folder / name) == [folder / name]


@pytest.mark.parametrize("name", ["a.#.exr", "a.%d.exr", "a[1].exr", "a*.exr"])
def test_a_file_of_that_very_name_is_no_pattern(name: str, folder: Path) -> None:
    (folder / name).touch()
    assert expanded(folder / name) == [folder / name]


@pytest.mark.parametrize("pattern", ["c.####.exr", "c.%04d.exr", "c.*.exr"])
def test_a_pattern_that_fits_nothing_is_refused(pattern: str, folder: Path) -> None:
    with pytest.raises(FileError, match=r"c\..*exr: expected files of this pattern, found none; the folder has 'a"):
        expanded(folder / pattern)
    with pytest.raises(FileError, match=r"nowhere"):
        expanded(folder / "nowhere" / pattern)


@pytest.mark.parametrize("pattern", ["a.##.##.exr", "a.%d.#.exr"])
def test_a_pattern_of_two_numbers_is_refused(pattern: str, folder: Path) -> None:
    with pytest.raises(FileError, match="expected one number, as #### or %04d, got 2"):
        expanded(folder / pattern)


def test_a_minus_belongs_to_the_number_behind_a_dot_or_an_underscore_alone(tmp_path: Path) -> None:
    for name in ("a1.exr", "a-2.exr", "b_1.exr", "b_-2.exr"):
        (tmp_path / name).touch()
    assert [path.name for path in expanded(tmp_path / "a#.exr")] == ["a1.exr"]
    assert [path.name for path in expanded(tmp_path / "a-#.exr")] == ["a-2.exr"]
    assert [path.name for path in expanded(tmp_path / "b_#.exr")] == ["b_-2.exr", "b_1.exr"]


def test_signs_of_other_languages_in_a_name_are_taken_as_they_are(tmp_path: Path) -> None:
    for name in ("a+(1).1.exr", "aa1.1.exr"):
        (tmp_path / name).touch()
    assert [path.name for path in expanded(tmp_path / "a+(1).#.exr")] == ["a+(1).1.exr"]


@pytest.mark.parametrize(
    ("pattern", "number", "name"),
    [
        ("####.exr", 7, "0007.exr"),
        ("s.#.exr", 7, "s.7.exr"),
        ("s.%04d.exr", 12345, "s.12345.exr"),
        ("s.%d.exr", 7, "s.7.exr"),
        ("s.%d.exr", -7, "s.-7.exr"),
        ("s.####.exr", -2, "s.-0002.exr"),
        ("v2.####.left.exr", 0, "v2.0000.left.exr"),
    ],
)
def test_a_number_is_put_into_a_pattern(pattern: str, number: int, name: str) -> None:
    assert numbered(Path("out") / pattern, number) == Path("out") / name


@pytest.mark.parametrize("pattern", ["b.####", "b.####.png", "b####exr"])
def test_pictures_are_not_named_otherwise_than_exr(pattern: str) -> None:
    with pytest.raises(FileError, match=r"expected a pattern that ends in \.exr, such as ####\.exr, or a folder"):
        numbered(Path(pattern), 1)


def test_a_folder_is_no_pattern(tmp_path: Path) -> None:
    assert has_number(tmp_path / "shot#1")
    (tmp_path / "shot#1").mkdir()
    assert not has_number(tmp_path / "shot#1")


@given(st.integers(-99999, 99999), st.integers(1, 6), st.booleans())
def test_what_a_pattern_makes_it_finds_again(number: int, width: int, hashes: bool) -> None:
    pattern = "s." + ("#" * width if hashes else f"%0{width}d") + ".exr"
    with tempfile.TemporaryDirectory() as folder:
        path = numbered(Path(folder) / pattern, number)
        path.touch()
        assert expanded(Path(folder) / pattern) == [path]


def test_frames_of_a_pattern_are_in_order(folder: Path) -> None:
    found = find_frames([folder / "a.####.exr"], allow_gaps=True)
    assert [path.name for path in found] == ["a.0001.exr", "a.0002.exr", "a.10000.exr"]


def test_a_gap_in_a_pattern_is_told(folder: Path) -> None:
    with pytest.raises(FileError, match=r"a\.0003\.exr: expected this frame between .*all missing frames: 3 to 9999"):
        find_frames([folder / "a.####.exr"])


@pytest.mark.parametrize(
    ("text", "span"), [("1-120", (1, 120)), ("7", (7, 7)), ("-5--1", (-5, -1)), ("-3-4", (-3, 4)), ("0-0", (0, 0))]
)
def test_ranges_are_read(text: str, span: tuple[int, int]) -> None:
    assert parse_range(text) == span


@pytest.mark.parametrize("text", ["", "5-1", "1-", "a", "1-2-3", "1..5", "1,2", "1 - 5", "٣", "1e3", "9999999999"])
def test_what_is_no_range_is_refused(text: str) -> None:
    with pytest.raises(SvgfError, match=r"--frames: expected FIRST-LAST such as 1-120, or one number, got "):
        parse_range(text)
