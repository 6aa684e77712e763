"""Which files are the frames of a shot, in which order, and what is said of those that are not."""

from __future__ import annotations

import os
import random
import tempfile
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from svgf_cl import FileError
from svgf_cl.io.frames import frame_path
from svgf_cl.io.sequence import after_gaps, check_leftovers, find_frames, find_numbered, frame_number
from tests.disk import unprivileged

# A warning that no test asks for is a failure.
pytestmark = pytest.mark.filterwarnings("error")


def touched(folder: Path, *names: str) -> list[Path]:
    """Empty files of these names."""
    folder.mkdir(exist_ok=True)
    for name in names:
        (folder / name).touch()
    return [folder / name for name in names]


ORDERED = {
    "unpadded": ["shot.1.exr", "shot.2.exr", "shot.3.exr"],
    "more digits than the padding": ["frame.9998.exr", "frame.9999.exr", "frame.10000.exr"],
    "negative": ["frame.-0002.exr", "frame.-0001.exr", "frame.0000.exr", "frame.0001.exr"],
    "negative, the minus in the padding": ["frame.-002.exr", "frame.-001.exr", "frame.0000.exr"],
    "bare numbers": ["0007.exr", "0008.exr", "0009.exr"],
    "bare numbers, negative": ["-1.exr", "0.exr", "1.exr"],
    "a dash that is no minus": ["shot-0001.exr", "shot-0002.exr", "shot-0003.exr"],
    "two dashes that are none": ["shot--0001.exr", "shot--0002.exr"],
    "an underscore": ["shot_v2_0001.exr", "shot_v2_0002.exr"],
    "a number before the frame's": ["a.2024.08.exr", "a.2024.09.exr", "a.2024.10.exr"],
    "something behind it": ["shot.0009.left.exr", "shot.0010.left.exr"],
    "upper case": ["SHOT.0009.EXR", "SHOT.0010.EXR"],
    "a line break": ["a\nb.1.exr", "a\nb.2.exr"],
}


@pytest.mark.parametrize("names", ORDERED.values(), ids=ORDERED)
def test_frames_come_by_number_from_lists_and_folders(tmp_path: Path, names: list[str]) -> None:
    files = touched(tmp_path, *names)
    shuffled = files.copy()
    random.Random(1).shuffle(shuffled)
    assert find_frames(shuffled) == find_frames(sorted(files)) == find_frames([tmp_path]) == files


def test_the_shell_s_order_is_not_time_s(tmp_path: Path) -> None:
    files = touched(tmp_path, *(f"shot.{number}.exr" for number in range(1, 12)))
    assert find_frames(sorted(files)) == files != sorted(files)


@settings(deadline=None, max_examples=50)
@given(
    numbers=st.sets(st.integers(-30, 30) | st.integers(9990, 10010), min_size=1, max_size=30),
    width=st.sampled_from((0, 4)),
    shuffler=st.randoms(),
)
def test_any_numbers_come_in_order_and_gaps_are_known(numbers: set[int], width: int, shuffler: random.Random) -> None:
    with tempfile.TemporaryDirectory() as folder:
        files = touched(Path(folder), *(f"a.{number:0{width}d}.exr" for number in sorted(numbers)))
        shuffled = files.copy()
        shuffler.shuffle(shuffled)
        assert find_frames(shuffled, allow_gaps=True) == files
        behind = numbers - {number + 1 for number in numbers} - {min(numbers)}
        assert {frame_number(path) for path in after_gaps(files)} == behind
        if behind:
            with pytest.raises(FileError, match="--allow-gaps"):
                find_frames(shuffled)


def test_a_single_file_needs_no_number(tmp_path: Path) -> None:
    (path,) = touched(tmp_path, "any name.exr")
    assert find_frames([path]) == [path]
    assert frame_number(path) is None
    assert not after_gaps([path])


GAPS = [
    (["frame.0003.exr", "frame.0004.exr", "frame.0007.exr"], r"frame\.0005\.exr: expected this frame", "5 to 6"),
    (["a.8.exr", "a.11.exr"], r"a\.9\.exr: .* between a\.8\.exr and a\.11\.exr", "9 to 10"),
    (["f.-0002.exr", "f.0001.exr"], r"f\.-0001\.exr: ", "-1 to 0"),
    (["1.exr", "3.exr", "5.exr", "9.exr"], r"2\.exr: ", "all missing frames: 2, 4, 6 to 8"),
    (["1.exr", f"{10**30}.exr"], r"2\.exr: ", "2 to 9999"),
]  # fmt: skip


@pytest.mark.parametrize(("names", "first", "all_"), GAPS)
def test_gaps_are_named_unless_allowed(tmp_path: Path, names: list[str], first: str, all_: str) -> None:
    files = touched(tmp_path, *names)
    for given_ in ([tmp_path], files):
        with pytest.raises(FileError, match=first) as error:
            find_frames(given_)
        assert all_ in str(error.value)
        assert "--allow-gaps" in str(error.value)
        assert find_frames(given_, allow_gaps=True) == files


REFUSED = {
    "two paddings of a number": (["frame.1.exr", "frame.0001.exr"], "expected one file for frame 1, found"),
    "minus nothing": (["frame.-0.exr", "frame.0.exr"], "expected one file for frame 0, found"),
    "several shots": (["a.1.exr", "a.2.exr", "b.3.exr"], "expected the frames of one shot"),
    "stems in other case": (["Frame.1.exr", "frame.2.exr"], "expected the frames of one shot"),
    "suffixes in other case": (["frame.0006.exr", "frame.0007.EXR"], "frame.0007.EXR (1 of its kind)"),
    "a copy": (["frame.0001.exr", "frame.0002.exr", "frame.0002 (1).exr"], "frame.0002 (1).exr"),
    "half a file": (["frame.0001.exr", "frame.0002.tmp.exr"], "frame.0002.tmp.exr"),
}


@pytest.mark.parametrize(("names", "words"), REFUSED.values(), ids=REFUSED)
def test_what_is_no_single_shot_is_refused(tmp_path: Path, names: list[str], words: str) -> None:
    files = touched(tmp_path, *names)
    for given_ in (files, [tmp_path]):
        for allow_gaps in (False, True):
            with pytest.raises(FileError) as error:
                find_frames(given_, allow_gaps=allow_gaps)
            assert words in str(error.value)
            assert sum(name in str(error.value) for name in names) >= 2


def test_files_without_a_number_have_no_order(tmp_path: Path) -> None:
    for names in (("one.exr", "two.exr"), ("frame.0001.exr", "two.exr")):
        with pytest.raises(FileError, match=r"(one|two)\.exr: expected a number in the name"):
            find_frames(touched(tmp_path, *names))


def test_shots_of_several_folders_are_not_one(tmp_path: Path) -> None:
    touched(tmp_path / "a", "frame.0001.exr")
    touched(tmp_path / "b", "frame.0002.exr")
    with pytest.raises(FileError, match="in one folder"):
        find_frames([tmp_path / "a", tmp_path / "b"])


def test_a_file_counts_once_whatever_it_is_called(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (path,) = touched(tmp_path / "a", "frame.0001.exr")
    (tmp_path / "link").symlink_to(tmp_path / "a")
    monkeypatch.chdir(tmp_path)
    for twice in ([path, path], [path, Path("a/frame.0001.exr")], [path, tmp_path / "link"], [tmp_path / "a", path]):
        with pytest.raises(FileError, match="expected every file once"):
            find_frames(twice)
    for make in (os.symlink, os.link):
        make(path, tmp_path / "a" / "frame.0002.exr")
        with pytest.raises(FileError, match=r"frame\.0002\.exr: expected every file once, .*frame\.0001\.exr"):
            find_frames([tmp_path / "a"])
        (tmp_path / "a" / "frame.0002.exr").unlink()


def test_links_to_frames_elsewhere_are_frames(tmp_path: Path) -> None:
    (tmp_path / "shot").mkdir()
    for number, path in enumerate(touched(tmp_path, "x.exr", "y.exr")):
        frame_path(tmp_path / "shot", number).symlink_to(path)
    assert find_frames([tmp_path / "shot"]) == [frame_path(tmp_path / "shot", number) for number in range(2)]


def test_a_link_to_nothing_is_named(tmp_path: Path) -> None:
    touched(tmp_path, "frame.0000.exr")
    frame_path(tmp_path, 1).symlink_to(tmp_path / "nowhere")
    with pytest.raises(FileError, match=r"frame\.0001\.exr: cannot be read"):
        find_frames([tmp_path])


def test_several_paddings_are_said(tmp_path: Path) -> None:
    files = touched(tmp_path, "frame.0001.exr", "frame.2.exr", "frame.0003.exr")
    with pytest.warns(UserWarning, match=r"^frame\.2\.exr: padded in another way than the other frames"):
        assert find_frames(files) == files


STRANGERS = ["frame.0002.exr.part", "frame.0002.tif", "Frame.0003.tmp", "frame.exr", "frame_0004.exr.bak"]


@pytest.mark.parametrize("stranger", STRANGERS)
def test_what_looks_like_a_frame_and_is_none_is_said(tmp_path: Path, stranger: str) -> None:
    files = touched(tmp_path, "frame.0000.exr", "frame.0001.exr")
    touched(tmp_path, stranger)
    with pytest.warns(UserWarning, match=f"not read, but named almost like frame.*: {stranger}$"):
        assert find_frames([tmp_path]) == files


def test_what_lies_beside_frames_for_a_reason_is_not_said(tmp_path: Path) -> None:
    files = touched(tmp_path, "frame.0000.exr", "frame.0001.exr")
    touched(tmp_path, "frame.0000.png", "._frame.0000.exr", ".frame.0002.exr.host-7.tmp", "reference.0000.exr")
    touched(tmp_path, "cameras.json", "take2.mov", "sky.exr", "preview.webp")
    (tmp_path / "frames2").mkdir()
    assert find_frames([tmp_path]) == files


def test_many_names_are_cut_short(tmp_path: Path) -> None:
    touched(tmp_path, "frame.0000.exr", *(f"frame.{number:04d}.exr.part" for number in range(1, 1000)))
    with pytest.warns(UserWarning, match="and 995 more$"):
        find_frames([tmp_path])


def test_frames_and_references_lie_side_by_side(tmp_path: Path) -> None:
    references = touched(tmp_path, "reference.0002.exr", "reference.0007.exr")
    assert find_numbered(tmp_path, "reference") == find_numbered(tmp_path, "frame") == references
    frames = touched(tmp_path, "frame.0001.exr", "frame.0002.exr")
    assert find_numbered(tmp_path, "reference") == references
    assert find_numbered(tmp_path, "frame") == find_frames([tmp_path]) == frames
    touched(tmp_path, "view.0002.exr")
    for stem in ("frame", "reference"):
        with pytest.raises(FileError, match=r"view\.0002\.exr \(1 of its kind\)"):
            find_numbered(tmp_path, stem)


def test_references_are_there_once(tmp_path: Path) -> None:
    touched(tmp_path, "reference.2.exr", "reference.0002.exr")
    with pytest.raises(FileError, match="expected one file for frame 2"):
        find_numbered(tmp_path, "reference")


def test_an_empty_or_missing_folder_is_an_error(tmp_path: Path) -> None:
    touched(tmp_path, "still.exr", "frame.0001.png")
    with pytest.raises(FileError, match=r"expected files named frame\.0000\.exr"):
        find_frames([tmp_path])
    with pytest.raises(FileError, match="nowhere: expected a file or a folder, found nothing"):
        find_frames([tmp_path / "nowhere"])


def test_a_folder_behind_a_closed_door_is_named(tmp_path: Path) -> None:
    with unprivileged(tmp_path), pytest.raises(FileError, match="cannot be read \\(Permission denied\\)"):
        find_frames([tmp_path])


@pytest.mark.parametrize(
    "name",
    ["frame.0001.exr", "frame.-0001.exr", "frame.0.exr", "frame.0003.EXR", "frame.0007.png", "reference.0000.exr",
     "still.0001.png", "shot_0002.exr", "shot_0002.png"],
)  # fmt: skip
def test_leftovers_are_named(tmp_path: Path, name: str) -> None:
    written = [frame_path(tmp_path, 0), tmp_path / "still.0000.png", tmp_path / "shot_0001.exr"]
    check_leftovers(tmp_path / "nowhere", written)
    for path in (*written, tmp_path / "photo.0007.exr", tmp_path / "preview.webp", tmp_path / "reference.0000.png"):
        path.touch()
    check_leftovers(tmp_path, written)
    (tmp_path / name).touch()
    with pytest.raises(FileError, match=f"{name}: left by an earlier run"):
        check_leftovers(tmp_path, written)
