"""Frames that are right raise no alarm, however small they are: `denoise` checks every shot it is given."""

from __future__ import annotations

import pytest

from svgf_cl import check_sequence
from svgf_cl.io.synthetic import room_frames


@pytest.mark.parametrize("shape", [(1, 1), (9, 16), (18, 32), (27, 48), (45, 80), (60, 100), (90, 160)])
@pytest.mark.parametrize("count", [1, 3])
def test_small_pictures_raise_no_alarm(shape: tuple[int, int], count: int) -> None:
    assert not check_sequence(room_frames(shape, count, signals=2)).findings
