"""The planar layout: images survive the way in and out, and every tap stays inside the plane."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_array_equal

from svgf_cl.device.layout import HALO, PAGE, WIDEST_VECTOR, Layout

layouts = st.builds(
    Layout, height=st.integers(1, 70), width=st.integers(1, 70), row_alignment=st.sampled_from((16, 64, 128, 256))
)


@given(layouts, st.integers(1, 3))
def test_crop_finds_every_pixel(layout: Layout, count: int) -> None:
    planes = np.arange(count * layout.plane, dtype=np.float32)
    assert planes.nbytes == layout.nbytes(32 * count)
    k, y, x = np.indices((count, layout.height, layout.width))
    assert_array_equal(layout.crop(planes), k * layout.plane + (y + HALO) * layout.pitch + HALO + x)


@pytest.mark.parametrize("spacing", [1, 2, 3])
@given(layouts)
def test_every_so_many_pixels_are_those_from_the_first_on(spacing: int, layout: Layout) -> None:
    coarse, taken = layout.every(spacing), np.indices((layout.height, layout.width))[:, ::spacing, ::spacing]
    assert (coarse.height, coarse.width) == taken.shape[1:]
    assert coarse.row_alignment == layout.row_alignment


@pytest.mark.parametrize(("side", "indexable"), [(16000, True), (17000, False)])
def test_indices_have_32_bits(side: int, indexable: bool) -> None:
    assert Layout(side, side).indexable(8) == indexable


@given(layouts)
def test_rows_hold_whole_vectors_and_a_halo_on_both_sides(layout: Layout) -> None:
    assert layout.pitch % layout.row_alignment == layout.pitch % WIDEST_VECTOR == 0
    assert layout.width + 2 * HALO <= layout.pitch < layout.width + 2 * HALO + layout.row_alignment


@pytest.mark.parametrize("width", [PAGE - 2 * HALO, 2 * PAGE - 2 * HALO])
@pytest.mark.parametrize("row_alignment", [16, 64, 256])
def test_rows_are_no_whole_pages_apart(width: int, row_alignment: int) -> None:
    assert Layout(1, width, row_alignment).pitch == width + 2 * HALO + row_alignment


@given(layouts)
def test_size_is_the_kernels_int4(layout: Layout) -> None:
    assert layout.size.dtype == np.int32
    assert layout.size.tolist() == [layout.width, layout.height, layout.pitch, layout.rows * layout.pitch]


def test_crop_leaves_out_half_a_plane_at_the_end() -> None:
    layout = Layout(2, 3)
    assert layout.crop(np.zeros(5 * layout.plane // 2)).shape == (2, 2, 3)


def test_crop_is_a_view() -> None:
    layout = Layout(2, 3)
    planes = np.zeros(2 * layout.plane)
    layout.crop(planes)[1, 0, 2] = 1
    assert planes.sum() == 1


@pytest.mark.parametrize("iterations", range(1, 6))
def test_halo_holds_the_reach_of_every_level(iterations: int) -> None:
    assert 2 * 2 ** (iterations - 1) <= HALO
