"""Frames of V-Ray in the names of Maya and in those of 3ds Max."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from svgf_cl import FileError, Frame, open_sequence
from tests.renderers import VRAY_HEADER, WORLD, Moment, Planes, moments, same_frames, truth, vray, written

SPELLINGS = ("maya", "max")


def expected(at: Moment) -> Frame:
    """The frame with normals as V-Ray has them: in screen space, x to the right, y up, z towards the viewer."""
    frame = truth(at)
    return replace(frame, normal=frame.normal @ WORLD[:3, :3].astype(np.float32))


@pytest.mark.parametrize("header", [{}, VRAY_HEADER])
@pytest.mark.parametrize("spelling", SPELLINGS)
def test_frames_are_read_in_both_spellings(spelling: str, header: dict, tmp_path: Path) -> None:
    frames = open_sequence(written(tmp_path, {at.number: vray(at, spelling) for at in moments()}, header))
    assert frames.reading.reader.name == "vray"
    same_frames(frames, [expected(at) for at in moments()])
    assert [light.filtered for light in frames.reading.lights] == [True, True, False]


def lacking(planes: Planes, *names: str) -> Planes:
    return {channel: plane for channel, plane in planes.items() if channel.split(".")[0] not in names}


@pytest.mark.parametrize("spelling", SPELLINGS)
@pytest.mark.parametrize(
    ("lost", "words"),
    [
        (("normals", "VRayNormals"), "expected normal in a file of V-Ray, .*; add the render element Normals"),
        (("z_depth", "VRayZDepth"), "expected depth in a file of V-Ray, .*; add the render element Z-depth"),
        (("velocity", "VRayVelocity"), "expected motion in a file of V-Ray, .*; add the render element Velocity"),
        (("R", "G", "B", "A"), "expected color in a file of V-Ray"),
    ],
)
def test_a_missing_element_is_named(spelling: str, lost: tuple[str, ...], words: str, tmp_path: Path) -> None:
    planes = {at.number: lacking(vray(at, spelling), *lost) for at in moments()}
    with pytest.raises(FileError, match=rf"shot_0001\.exr: {words}"):
        open_sequence(written(tmp_path, planes))[0]


def test_ids_of_a_mask_may_be_read_from_another_element(tmp_path: Path) -> None:
    at = moments()[0]
    masks = {"multimatte.red": np.full(at.frame.shape, 9, np.float32)}
    (frame,) = open_sequence(written(tmp_path, {1: vray(at) | masks}), passes={"id": "multimatte"})
    assert (frame.id == 9).all()
    assert frame.id.dtype == np.uint32
