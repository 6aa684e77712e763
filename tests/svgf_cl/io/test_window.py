from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from svgf_cl.io.window import Window, placed, union

WINDOWS = st.builds(Window, st.integers(-5, 5), st.integers(-5, 5), st.integers(1, 6), st.integers(1, 6))


def pixels(window: Window) -> dict[tuple[int, int], tuple[int, int]]:
    """Where each of its pixels is in an array."""
    return {(window.x + i, window.y + j): (j, i) for j in range(window.height) for i in range(window.width)}


@given(WINDOWS, WINDOWS)
def test_a_pixel_keeps_its_place(have: Window, want: Window) -> None:
    plane = np.arange(have.area * 2, dtype=np.float32).reshape(have.height, have.width, 2)
    result, before = placed(plane, have, want, np.inf), pixels(have)
    for place, index in pixels(want).items():
        expected = plane[before[place]] if place in before else np.full(2, np.inf, np.float32)
        np.testing.assert_array_equal(result[index], expected)


@given(st.lists(WINDOWS, min_size=1, max_size=4))
def test_the_union_is_the_smallest_that_has_them_all(windows: list[Window]) -> None:
    everything = union(windows)
    inside = [place for window in windows for place in pixels(window)]
    assert set(inside) <= pixels(everything).keys()
    for axis, start, length in ((0, everything.x, everything.width), (1, everything.y, everything.height)):
        assert min(place[axis] for place in inside) == start
        assert max(place[axis] for place in inside) == start + length - 1
