"""Shots of scenes: which frames are judged, what is rendered, and what it all depends on."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from svgf_cl.compare.footage import Choice, opener
from svgf_cl_tracer.cli.footage import Traced, open_footage

TINY = Choice(shape=(32, 48), frames=4, judged=2, spp=32, jitter=True)


def test_it_is_what_opens_scenes() -> None:
    assert opener() is open_footage


def test_all_frames_that_history_is_long_in_are_judged() -> None:
    def judged(scene: str, frames: int | None = None, judged: int | None = None) -> range:
        return Traced(scene, replace(TINY, frames=frames, judged=judged)).judged

    assert judged("swing") == range(8, 48)
    assert judged("cornell") == range(8, 24)
    assert judged("some.glb") == range(8, 24)
    assert judged("swing", 4) == range(2, 4)
    assert judged("swing", 1) == range(1)
    assert judged("swing", 12, 3) == range(9, 12)
    assert judged("swing", 3, 12) == range(3)


def test_frames_are_one_signal_and_the_truth_is_two_halves() -> None:
    footage = open_footage("swing", TINY)
    assert (footage.name, footage.shape, footage.jitter) == ("swing", (32, 48), True)
    frames = list(footage.frames())
    assert len(frames) == len(footage.numbers) == 4
    assert all(frame.direct is None and frame.indirect is None for frame in frames)
    ticks: list[None] = []
    truths = footage.truths(lambda: ticks.append(None))
    assert len(ticks) == footage.steps
    assert list(truths) == [2, 3]
    for number, (first, second) in truths.items():
        assert first.shape == second.shape == (32, 48, 3)
        assert not np.array_equal(first, second), "independent"
        assert first.mean() == pytest.approx(second.mean(), rel=0.1)
        assert frames[number].color.mean() == pytest.approx(first.mean(), rel=0.2)


def test_the_identity_is_of_all_that_pictures_depend_on() -> None:
    changes = ({}, {"shape": (32, 50)}, {"frames": 5}, {"judged": 1}, {"spp": 64}, {"jitter": False})
    names = {Traced("swing", replace(TINY, **change)).identity for change in changes}
    names.add(Traced("cornell", TINY).identity)
    assert len(names) == len(changes) + 1
    assert Traced("swing", TINY).identity in names


@pytest.mark.parametrize("jitter", [False, True])
def test_the_note_says_how_it_was_rendered(jitter: bool) -> None:
    rays = "rays move within the pixel" if jitter else "rays go through pixel centres"
    expected = f"1 sample per pixel, {rays}; truth of 32 samples per pixel"
    assert Traced("swing", replace(TINY, jitter=jitter)).note == expected
