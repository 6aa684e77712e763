"""Fields in files of their own, one file a pass and frame."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from svgf_cl import FileError, SvgfError, open_sequence
from svgf_cl.io.window import Window
from tests.exr_files import exr_bytes
from tests.renderers import (
    ARNOLD_HEADER,
    NUMBERS,
    SHAPE,
    Planes,
    arnold,
    blender,
    layer,
    moments,
    own,
    rgb,
    same_frames,
    truth,
    written,
)


def one_each(folder: Path, stem: str, name: str, size: int) -> str:
    """Files of one field, as a pass without a layer's name, and their pattern."""
    planes: dict[int, Planes] = {}
    for at in moments():
        value = getattr(at.frame, name).reshape(*SHAPE, -1)
        letters = "Z" if size == 1 else "RGB"[:size] if name != "motion" else "XY"
        planes[at.number] = {c: np.ascontiguousarray(value[..., i]) for i, c in enumerate(letters)}
    written(folder, planes, stem=stem)
    return str(folder / f"{stem}####.exr")


def beauty(folder: Path) -> str:
    written(folder, {at.number: rgb(at.frame.color) for at in moments()}, stem="beauty.")
    return str(folder / "beauty.%04d.exr")


def test_fields_are_read_from_files_of_their_own(tmp_path: Path) -> None:
    separate = {
        "albedo": one_each(tmp_path, "albedo.", "albedo", 3),
        "normal": one_each(tmp_path / "n", "N.", "normal", 3),
        "depth": one_each(tmp_path, "Z.", "depth", 1),
        "motion": one_each(tmp_path, "mv.", "motion", 2),
        "id": one_each(tmp_path, "id_", "id", 1),
    }
    frames = open_sequence(beauty(tmp_path), separate=separate)
    same_frames(frames, [truth(at, "emission") for at in moments()])


def test_a_field_of_its_own_comes_before_that_of_the_frame(tmp_path: Path) -> None:
    written(tmp_path, {at.number: own(at) for at in moments()})
    depth = {at.number: {"Z": at.frame.depth * 2} for at in moments()}
    written(tmp_path / "z", depth, stem="z.")
    frames = open_sequence(tmp_path, separate={"depth": tmp_path / "z"})
    np.testing.assert_array_equal(frames[1].depth, moments()[1].frame.depth * 2)


def test_what_is_known_of_a_renderer_holds_for_its_separate_files(tmp_path: Path) -> None:
    """The vectors of Blender and of Arnold point up wherever they are."""
    for name, make, header in (
        ("ViewLayer.Vector", lambda at: blender(at), {}),
        ("motionvector", lambda at: arnold(at, motion=True, position=False), ARNOLD_HEADER),
    ):
        folder = tmp_path / name
        whole = {at.number: make(at) for at in moments()}
        vectors = {n: {c: p for c, p in planes.items() if c.startswith(name)} for n, planes in whole.items()}
        rest = {n: {c: p for c, p in planes.items() if not c.startswith(name)} for n, planes in whole.items()}
        written(folder, rest, header)
        written(folder, vectors, header, "vector.")
        frames = open_sequence(folder / "shot_####.exr", separate={"motion": folder / "vector.####.exr"})
        same_frames(frames, [truth(at) for at in moments()])


def without_depth(folder: Path) -> Path:
    fields = {"color", "normal", "motion"}
    return written(folder, {at.number: own(at, fields) for at in moments()})


def test_a_frame_without_its_file_is_named(tmp_path: Path) -> None:
    pattern = one_each(tmp_path / "z", "z.", "depth", 1)
    (tmp_path / "z" / "z.0002.exr").unlink()
    folder = without_depth(tmp_path / "shot")
    separate = {"albedo": one_each(tmp_path / "a", "a.", "albedo", 3), "depth": pattern}
    with pytest.raises(FileError, match=r"z\.0001\.exr: expected a file of depth for frame 2, found none"):
        open_sequence(folder, separate=separate)


@pytest.mark.parametrize("field", ["color", "Depth", "motion_to_next"])
def test_what_is_no_field_of_its_own_is_refused(field: str, tmp_path: Path) -> None:
    with pytest.raises(SvgfError, match=f"separate: expected one of albedo, .*, got '{field}'"):
        open_sequence(without_depth(tmp_path), separate={field: tmp_path})


@pytest.mark.parametrize(
    ("planes", "words"),
    [
        (
            layer("a", np.ones((*SHAPE, 3), np.float32)) | layer("b", np.ones((*SHAPE, 3), np.float32)),
            "one pass, or R G B",
        ),
        ({"Z": np.ones((5, 6), np.float32)}, "6x5"),
    ],
)
def test_a_file_that_cannot_be_the_field_of_its_frame_is_named(planes: Planes, words: str, tmp_path: Path) -> None:
    written(tmp_path / "z", dict.fromkeys(NUMBERS, planes), stem="z.")
    with pytest.raises(FileError, match=rf"z\.0001\.exr: expected .*{words}"):
        open_sequence(without_depth(tmp_path / "shot"), separate={"depth": tmp_path / "z"})[0]


def test_a_file_on_another_window_than_its_frame_is_named(tmp_path: Path) -> None:
    """Its pixels would lie beside those that they belong to."""
    folder = written(tmp_path / "z", {at.number: {"Z": at.frame.depth} for at in moments()}, stem="z.")
    display = Window(0, 0, SHAPE[1], SHAPE[0])
    (folder / "z.0002.exr").write_bytes(exr_bytes({"Z": moments()[1].frame.depth}, at=(3, 0), display=display))
    frames = open_sequence(without_depth(tmp_path / "shot"), separate={"depth": folder})
    assert frames[0].depth.any()
    with pytest.raises(FileError, match=r"z\.0002\.exr: expected the data window 32x20 at 0,0 of .*, got 32x20 at 3,0"):
        frames[1]


def test_too_few_components_are_told(tmp_path: Path) -> None:
    written(tmp_path / "n", {at.number: {"Z": at.frame.depth} for at in moments()}, stem="n.")
    with pytest.raises(FileError, match=r"expected 3 components of normal in its file, found 1"):
        open_sequence(without_depth(tmp_path / "shot"), separate={"normal": tmp_path / "n"})


def test_a_pattern_that_fits_nothing_is_refused(tmp_path: Path) -> None:
    with pytest.raises(FileError, match=r"z\.####\.exr: expected files of this pattern, found none"):
        open_sequence(without_depth(tmp_path), separate={"depth": tmp_path / "z.####.exr"})
