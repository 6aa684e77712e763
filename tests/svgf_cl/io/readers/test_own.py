"""Our own channels, ids among them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from svgf_cl import FileError, Frame, open_sequence
from svgf_cl.io.readers.own import CHANNEL_NAMES, OWN, needed
from tests.renderers import Moment, moments, own, same_frames, truth, written


def test_frames_are_read(tmp_path: Path) -> None:
    frames = open_sequence(written(tmp_path, {at.number: own(at) for at in moments()}))
    assert frames.reading.reader is OWN
    same_frames(frames, [at.frame for at in moments()])


@pytest.mark.parametrize(
    ("field", "words"),
    [
        ("normal", "expected channels normal.X normal.Y normal.Z, found "),
        ("depth", "expected channels depth.Z, found "),
        ("motion", "expected channels motion.X motion.Y, found .*--still-camera"),
        ("color", "expected channels R G B, found "),
    ],
)
def test_a_missing_field_is_named(field: str, words: str, tmp_path: Path) -> None:
    fields = {"color", "normal", "depth", "motion", "albedo"} - {field}
    frames = open_sequence(written(tmp_path, {at.number: own(at, fields) for at in moments()}))
    with pytest.raises(FileError, match=rf"shot_0001\.exr: {words}"):
        frames[0]


@pytest.mark.parametrize("field", [name for name in CHANNEL_NAMES if len(needed(name)) > 1])
def test_a_field_that_is_there_in_part_is_refused(field: str, tmp_path: Path) -> None:
    planes = own(moments()[0]) | {name: np.zeros((20, 32), np.float32) for name in needed(field)}
    del planes[needed(field)[-1]]
    planes = {name: plane for name, plane in planes.items() if name != "motion.Z"}
    words = rf"shot_0001\.exr: expected channels {' '.join(needed(field))}.*, found only "
    with pytest.raises(FileError, match=words):
        open_sequence(written(tmp_path, {1: planes}))


@pytest.mark.parametrize("value", [-1.0, 0.5, 2.0**24 + 2, np.nan, np.inf])
def test_ids_that_are_no_whole_numbers_are_refused(value: float, tmp_path: Path) -> None:
    planes = own(moments()[0])
    planes["id"] = planes["id"].astype(np.float32)
    planes["id"][3, 4] = value
    frames = open_sequence(written(tmp_path, {1: planes}))
    with pytest.raises(FileError, match=r"shot_0001\.exr: expected whole numbers in 0..16777216 in channel id, got "):
        frames[0]


def test_light_in_parts_needs_no_picture(tmp_path: Path) -> None:
    planes = {at.number: {c: p for c, p in own(at).items() if c not in tuple("RGB")} for at in moments()}
    frames = open_sequence(written(tmp_path, planes))
    same_frames(frames, [truth_in_parts(at) for at in moments()])
    assert frames.reading.picture == ("R", "G", "B")


def truth_in_parts(at: Moment) -> Frame:
    frame = truth(at, "color", motion=3)
    return Frame(**{**frame.present(), "direct": at.frame.direct, "indirect": at.frame.indirect})
