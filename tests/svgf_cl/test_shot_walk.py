"""A shot's files, gone along both ways: where motion to the next frame is from, and where history ends."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest

from svgf_cl import open_sequence
from svgf_cl.filters import DEFAULT
from svgf_cl.io.shot import Shot, ShotFrame
from svgf_cl.lights import WHOLE
from svgf_cl.look_ahead import both_ways
from svgf_cl.next_motion import motion_to_next
from svgf_cl.shot_denoiser import Method, ShotDenoiser
from svgf_cl.shot_walk import ShotWalk
from tests.renderers import (
    BLENDER_HEADER,
    MITSUBA_HEADER,
    NUMBERS,
    Moment,
    blender,
    cameras_file,
    mitsuba,
    moments,
    own,
    written,
)

METHOD = Method(DEFAULT(iterations=1), prefilter="off")


def walk_of(shot: Shot, places: range | None = None, **chosen: object) -> ShotWalk:
    return ShotWalk(shot, METHOD, places or range(len(shot)), **chosen)  # type: ignore[arg-type]


def blender_shot(folder: Path, numbers: tuple[int, ...] = (1, 2, 3)) -> Shot:
    planes = {at.number: blender(at) for at in moments(numbers)}
    return open_sequence(written(folder, planes, BLENDER_HEADER), allow_gaps=True)


def to_next(walk: ShotWalk, index: int) -> np.ndarray:
    return walk.to_next(index, walk.item(index), walk.item(index + 1))


def assert_true(motion: np.ndarray, at: Moment) -> None:
    """To the next frame, wherever a surface is seen."""
    np.testing.assert_allclose(motion[..., :2][at.hit], at.to_next[at.hit], atol=2e-3)


def test_motion_to_the_next_frame_is_that_of_the_file(tmp_path: Path) -> None:
    assert_true(to_next(walk_of(blender_shot(tmp_path)), 1), moments()[1])


def test_or_that_of_cameras_where_they_tell_motion(tmp_path: Path) -> None:
    planes = {at.number: mitsuba(at) for at in moments()}
    written(tmp_path, planes, MITSUBA_HEADER)
    cameras_file(tmp_path, NUMBERS)
    walk = walk_of(open_sequence(tmp_path))
    assert_true(to_next(walk, 0), moments()[0])
    assert_true(to_next(walk, 1), moments()[1])


def test_or_else_that_of_the_next_frame_turned_round(tmp_path: Path) -> None:
    written(tmp_path, {at.number: own(at) for at in moments()})
    walk = walk_of(open_sequence(tmp_path))
    frames = [at.frame for at in moments()]
    np.testing.assert_array_equal(to_next(walk, 0), motion_to_next(frames[0], frames[1]))


def test_cuts_are_counted_from_where_the_walk_begins(tmp_path: Path) -> None:
    shot = blender_shot(tmp_path, (1, 2, 4, 5, 8))
    assert shot.cuts == {2, 4}
    assert walk_of(shot).cuts == [2, 4]
    assert walk_of(shot, range(1, 5)).cuts == [1, 3]
    assert walk_of(shot, range(2, 4)).cuts == []
    walk = walk_of(shot, range(1, 4))
    assert len(walk) == 3
    assert walk.item(0)[0] == 1
    assert walk.item(2)[1].path == shot.paths[3]


def test_no_light_crosses_a_cut(tmp_path: Path) -> None:
    """A frame alone between two cuts comes out as one without any others, from files that look ahead or not."""
    shot = blender_shot(tmp_path, (1, 3, 5))
    walk = walk_of(shot)
    pictures = [walk.composed(parts).picture for _, parts in both_ways(walk, walk.cuts, None)]
    alone = ShotDenoiser(shot.shape, METHOD, len(shot.reading.lights))
    for index, picture in enumerate(pictures):
        source = shot.read(index)
        alone.reset()
        expected = alone.denoise(source.frame, source.lights).picture
        np.testing.assert_allclose(picture, expected, rtol=1e-6, atol=1e-6)


def test_light_that_shines_in_later_frames_alone_leaves_earlier_ones_dark(tmp_path: Path) -> None:
    """Its backward run has it already where the forward run has not."""
    planes: dict[int, Mapping[str, np.ndarray]] = {}
    for at in moments():
        channels = blender(at)
        dark = {name: plane * (at.number > 1) for name, plane in channels.items() if ".DiffInd." in name}
        color = {f"ViewLayer.Combined.{c}": channels[f"ViewLayer.Combined.{c}"] for c in "RGB"}
        if at.number == 1:
            color = {name: plane - at.frame.indirect[..., i] for i, (name, plane) in enumerate(color.items())}
        planes[at.number] = {**channels, **dark, **color}
    shot = open_sequence(written(tmp_path, planes, BLENDER_HEADER))  # type: ignore[arg-type]
    walk, name = walk_of(shot), tuple(f"ViewLayer.DiffInd.{c}" for c in "RGB")
    found = [walk.composed(parts) for _, parts in both_ways(walk, walk.cuts, None)]
    assert [bool(each.lights[name].any()) for each in found] == [False, True, True]
    assert all(np.isfinite(each.picture).all() for each in found)


def test_frames_are_looked_at_once_and_in_order(tmp_path: Path) -> None:
    seen: list[int] = []

    def look(shot: Shot, index: int, source: ShotFrame) -> None:
        seen.append(index)

    walk = walk_of(blender_shot(tmp_path), range(1, 3), look=look)
    list(both_ways(walk, walk.cuts, 1))
    assert seen == [1, 2]


def test_both_filters_share_the_memory_of_the_device(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    shares: list[float] = []

    class Spy(ShotDenoiser):
        def __init__(self, *arguments: object, share: float) -> None:
            super().__init__(*arguments, share=share)  # type: ignore[arg-type]
            shares.append(share)

    monkeypatch.setattr("svgf_cl.shot_walk.ShotDenoiser", Spy)
    walk_of(blender_shot(tmp_path))
    assert sum(shares) == 1.0


def test_a_picture_without_passes_is_averaged_as_a_whole(tmp_path: Path) -> None:
    written(tmp_path, {at.number: own(at, ("color", "normal", "depth", "motion")) for at in moments()})
    walk = walk_of(open_sequence(tmp_path))
    for _, parts in both_ways(walk, walk.cuts, None):
        assert parts.keys() == {WHOLE}
        np.testing.assert_array_equal(walk.composed(parts).picture, parts[WHOLE])
