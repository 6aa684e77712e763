"""Random rooms are scenes: the same for the same seed, lit, and seen from inside."""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("embreex")

import svgf_cl_tracer
from benchmarks.training.rooms import THINGS, room


@pytest.mark.parametrize("seed", range(4))
def test_a_room_is_full_and_lit(seed: int) -> None:
    scene = room(seed)
    assert len(scene.instances) > THINGS + 5
    shot = svgf_cl_tracer.Shot(scene, (18, 32), 10)
    frames = [svgf_cl_tracer.render_frame(shot, number) for number in range(3)]
    assert np.mean(np.isfinite(frames[0].depth)) > 0.8
    assert np.mean([frame.color.mean() for frame in frames]) > 0.005


def test_a_seed_says_all() -> None:
    shapes = [svgf_cl_tracer.Shot(room(seed), (18, 32), 10).identity for seed in (1, 1, 2)]
    assert shapes[0] == shapes[1] != shapes[2]


def test_things_move_in_every_second_room() -> None:
    assert [room(seed).changes for seed in range(4)] == [False, True, False, True]
