"""Frames that are right raise no alarm, however small they are: `denoise` checks every shot it is given."""

from __future__ import annotations

from dataclasses import replace

import pytest

from svgf_cl import check_sequence
from svgf_cl.io.synthetic import room_frames


@pytest.mark.parametrize("shape", [(1, 1), (9, 16), (18, 32), (27, 48), (45, 80), (60, 100), (90, 160)])
@pytest.mark.parametrize("count", [1, 3])
def test_small_pictures_raise_no_alarm(shape: tuple[int, int], count: int) -> None:
    assert not check_sequence(room_frames(shape, count, signals=2)).findings


@pytest.mark.parametrize(("shape", "count"), [((48, 64), 3), ((72, 128), 2), ((90, 160), 2)])
def test_fields_that_are_left_out_raise_no_alarm(shape: tuple[int, int], count: int) -> None:
    """Without albedo, wrong motion may fit a little better than right motion does, by chance."""
    frames = [replace(frame, albedo=None, id=None) for frame in room_frames(shape, count)]
    assert not check_sequence(frames).findings
