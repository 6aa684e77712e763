"""Clips of scenes: what stands for an installed tracer renders them, and a room needs none."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

import numpy as np
import pytest

from svgf_cl import Frame, SvgfError
from svgf_cl.compare.footage import Choice
from svgf_cl.compare.halves import Pair
from svgf_cl.io.synthetic import room_frames
from svgf_cl.view import scenes as module
from svgf_cl.view.scenes import open_footage, room, scene

SHAPE = (18, 32)


class Rendered:
    """Footage of the room whose truth differs in its halves."""

    name, note, shape, identity = "stage", "as it was made", SHAPE, "stage"
    numbers, judged, steps = range(3), range(3), 3

    def __init__(self, *, jitter: bool = False) -> None:
        self.jitter = jitter

    def frames(self) -> Iterator[Frame]:
        return room_frames(SHAPE, 3)

    def truths(self, advance: Callable[[], None]) -> Mapping[int, Pair]:
        found = {}
        for number in self.judged:
            advance()
            found[number] = (np.full((*SHAPE, 3), number), np.full((*SHAPE, 3), number + 1.0))
        return found


def test_references_are_the_mean_of_both_halves() -> None:
    steps: list[int] = []
    clip = scene(Rendered(), has_references=True, advance=lambda: steps.append(1))
    assert (clip.name, clip.note, clip.has_references, len(steps)) == ("stage", "as it was made", True, 3)
    for index, frame in enumerate(room_frames(SHAPE, 3)):
        item = clip.read(index)
        assert np.array_equal(item.noisy, frame.color)
        assert np.array_equal(item.reference, np.full((*SHAPE, 3), index + 0.5, np.float32))


@pytest.mark.parametrize(
    ("jitter", "rays"), [(False, "rays go through pixel centres"), (True, "rays move within the pixel")]
)
def test_without_references_none_is_rendered(jitter: bool, rays: str) -> None:
    def advance() -> None:
        raise AssertionError("expected no truth")

    clip = scene(Rendered(jitter=jitter), has_references=False, advance=advance)
    assert (clip.has_references, clip.read(1).reference) == (False, None)
    assert clip.note == f"1 sample per pixel, {rays}; no reference"


@pytest.mark.parametrize("jitter", [False, True])
def test_a_scene_is_opened_by_what_is_installed(jitter: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[tuple[str, Choice]] = []
    monkeypatch.setattr(module, "opener", lambda: lambda name, choice: asked.append((name, choice)) or Rendered())
    assert isinstance(open_footage("stage", SHAPE, 5, 32, jitter=jitter), Rendered)
    ((name, choice),) = asked
    assert (name, choice.shape, choice.frames, choice.spp, choice.jitter) == ("stage", SHAPE, 5, 32, jitter)
    assert choice.judged is not None
    assert choice.judged >= 5, "every frame has a reference"


def test_without_anything_that_renders_the_error_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("svgf_cl.compare.footage.entry_points", lambda group: [])
    with pytest.raises(SvgfError, match="needs the tracer: pip install"):
        open_footage("cornell", SHAPE, None, None, jitter=False)


def test_the_rooms_reference_is_what_its_noise_averages_to() -> None:
    clip = room((9, 16), 200)
    items = [clip.read(index) for index in range(0, 200, 8)]  # the camera is in one place again every eight frames
    assert all(np.array_equal(item.reference, items[0].reference) for item in items)
    mean = np.mean([item.noisy for item in items], axis=0)
    assert abs(mean.mean() / items[0].reference.mean() - 1) < 0.05
    assert len(room((9, 16), None).numbers) == module.ROOM_FRAMES
