"""Names say what was timed."""

from __future__ import annotations

import pyopencl as cl

from svgf_cl import Eaw, Settings
from svgf_cl.bench.cases import ROOM, SHAPES, USUAL_SHAPE, Case, cases
from svgf_cl.bench.rig import FRAME


def test_names() -> None:
    case = Case((1080, 1920), Settings())
    names = [case.name(row) for row in case.rows]
    assert {"svgf.demodulate.1920x1080", "svgf.atrous.1920x1080", "svgf.atrous.3.1920x1080"} <= set(names)
    assert {"svgf.frame.1920x1080", "svgf.frame.numpy.1920x1080", "svgf.enqueue.1920x1080"} <= set(names)
    assert len(set(names)) == len(names)
    assert Case((4, 3), Settings(), variant="signals2").name(FRAME) == "svgf.frame.signals2.3x4"


def test_names_say_which_filter() -> None:
    assert Case((4, 3), Eaw()).name(("atrous", "2")) == "eaw.atrous.2.3x4"


def test_only_one_thing_varies_at_a_time(queue: cl.CommandQueue) -> None:
    found = list(cases(queue.device, SHAPES, Settings()))
    assert [case.shape for case in found if not case.variant] == list(SHAPES)
    for case in (case for case in found if case.variant):
        unusual = [case.settings != Settings(), case.inputs != ROOM, case.cores is not None]
        assert case.shape == USUAL_SHAPE
        assert sum(unusual) <= 1
        assert case.rows == [FRAME]


def test_costs_are_those_of_the_whole_image() -> None:
    small, large = Case((10, 10), Settings()).costs(), Case((20, 10), Settings()).costs()
    assert small.keys() == large.keys()
    assert all(large[name] == small[name] * 2 for name in small)
