"""How an image is cut into tiles."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from svgf_cl.device.tiles import best_window, count, spans, tiles_of, window_lengths

LENGTHS = st.integers(1, 3000)
MARGINS = st.integers(0, 90)
UNITS = st.sampled_from([16, 32])


@given(LENGTHS, MARGINS, UNITS, st.data())
def test_parts_make_up_the_axis_and_have_their_margin_unless_the_image_ends(
    length: int, margin: int, unit: int, data: st.DataObject
) -> None:
    window = data.draw(st.sampled_from(window_lengths(length, margin, unit)))
    found = spans(length, window, margin, unit)
    assert [each.begin for each in found] == [0, *(each.end for each in found[:-1])]
    assert found[-1].end == length
    for each in found:
        assert each.origin % unit == 0
        assert each.begin < each.end
        assert 0 <= each.origin <= each.origin + each.length <= length
        assert each.length == window
        assert each.origin == 0 or each.begin - each.origin >= margin
        assert each.origin + window == length or each.origin + window - each.end >= margin


@given(LENGTHS, MARGINS, UNITS)
def test_fewer_windows_are_longer(length: int, margin: int, unit: int) -> None:
    lengths = window_lengths(length, margin, unit)
    assert lengths[0] == length
    assert lengths == sorted(set(lengths), reverse=True)
    counts = [count(length, each, margin, unit) for each in lengths]
    assert counts == sorted(set(counts))


def test_tiles_cover_every_pixel_once() -> None:
    seen = np.zeros((301, 517), int)
    for tile in tiles_of(seen.shape, window_shape := (109, 165), 20, 32):
        seen[tile.kept] += 1
        rows, columns = tile.around(7)
        assert np.zeros(window_shape)[rows, columns].shape >= np.zeros(window_shape)[tile.around()].shape
    assert (seen == 1).all()


def test_the_best_window_is_that_of_least_work() -> None:
    def fits(window: tuple[int, int]) -> bool:
        return window[0] * window[1] <= 100_000

    best = best_window((1080, 1920), 30, 32, fits)
    assert best is not None
    assert fits(best)
    tiles = len(tiles_of((1080, 1920), best, 30, 32))
    narrow = (248, 384)
    assert fits(narrow)
    assert tiles * best[0] * best[1] <= len(tiles_of((1080, 1920), narrow, 30, 32)) * narrow[0] * narrow[1]
    assert best_window((1080, 1920), 30, 32, lambda _: False) is None
