"""What is played: frames that are rendered once, and room for no more than memory has."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

from svgf_cl import SvgfError
from svgf_cl.io.shot import Light
from svgf_cl.view import clip as module
from svgf_cl.view.clip import Item, RenderedClip
from tests.frames import FULL, SPLIT, bumpy_sequence

SHAPE = (7, 9)


def clip_of(items: Iterator[Item], count: int) -> RenderedClip:
    return RenderedClip("name", "note", SHAPE, count, items, has_references=False)


def items(count: int) -> list[Item]:
    fields = (*FULL, "diffuse", "specular", "roughness", "hit_distance")
    return [Item(frame) for frame in bumpy_sequence(fields, count=count, shape=SHAPE)]


def test_frames_are_rendered_when_they_are_asked_for_and_once() -> None:
    rendered, wanted = [], items(4)

    def render() -> Iterator[Item]:
        for index, item in enumerate(wanted):
            rendered.append(index)
            yield item

    clip = clip_of(render(), 4)
    assert rendered == []
    assert len(clip.beginning()) == 2
    assert rendered == [0, 1]
    assert clip.read(3).frame.color is wanted[3].frame.color
    assert clip.read(0) is clip.read(0)
    assert rendered == [0, 1, 2, 3]


def test_a_clip_of_one_frame_begins_with_it_twice() -> None:
    first, second = clip_of(iter(items(1)), 1).beginning()
    assert first is second


def test_what_no_filter_reads_is_not_kept() -> None:
    frame = clip_of(iter(items(1)), 1).read(0).frame
    assert set(frame.present()) == {"color", "albedo", "normal", "depth", "motion", "id", "emission"}


def test_more_frames_than_memory_has_room_for_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    (item,) = items(1)
    kept = clip_of(iter([item]), 1).read(0)
    monkeypatch.setattr(module, "MEMORY", 3 * kept.nbytes)
    assert clip_of(iter(items(3)), 3).read(2)
    with pytest.raises(
        SvgfError, match=r"--frames: expected at most 3 frames of 9x7 pixels, .* got 4; .* svgf-cl render"
    ):
        clip_of(iter(items(4)), 4).read(0)


def test_a_rendering_that_broke_off_says_so_again_and_again() -> None:
    clip = clip_of(iter(items(1)), 3)
    for _ in range(2):
        with pytest.raises(SvgfError, match="rendering broke off at an earlier frame; start svgf-cl view again"):
            clip.read(2)


def test_a_picture_in_parts_is_shown_as_their_sum() -> None:
    (frame,) = bumpy_sequence(SPLIT, count=1, shape=SHAPE)
    assert frame.color is None
    assert np.allclose(Item(frame).noisy, frame.direct + frame.indirect + frame.emission)


def test_all_arrays_count_as_memory() -> None:
    (frame,) = bumpy_sequence(("color",), count=1, shape=SHAPE)
    picture = np.zeros((*SHAPE, 3), np.float32)
    bare = Item(frame).nbytes
    assert bare == 4 * 7 * 9 * (3 + 3 + 1 + 3)
    assert Item(frame, (Light(("R", "G", "B"), picture, picture),), picture).nbytes == bare + 3 * picture.nbytes
