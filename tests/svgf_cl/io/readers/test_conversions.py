"""Passes that several renderers write alike."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from svgf_cl.io.readers.conversions import (
    against_time,
    along_time,
    depth_of_hits,
    hashes,
    reflected,
    without_edges,
    y_down,
)


def test_an_id_between_two_becomes_that_of_a_neighbour() -> None:
    ids = np.array([[1, 1.5, 2], [1, np.nan, 2], [np.inf, -3, 2.0**33]], np.float32)
    found = without_edges(ids)
    assert found.dtype == np.uint32
    assert set(np.unique(found)) <= {1, 2}


@given(st.integers(0, 2**32 - 1))
def test_whole_ids_stay_as_they_are(number: int) -> None:
    ids = np.full((2, 3), number, np.uint32)
    np.testing.assert_array_equal(without_edges(ids), ids, strict=True)


def test_where_nothing_was_hit_depth_is_infinite() -> None:
    depth = np.array([[0.0, -1.0, 1e10, np.inf, np.nan, 2.5, 1e8]], np.float32)
    expected = np.array([[np.inf, np.inf, np.inf, np.inf, np.inf, 2.5, 1e8]], np.float32)
    np.testing.assert_array_equal(depth_of_hits(depth), expected, strict=True)


def test_the_albedo_of_a_lamp_is_one() -> None:
    albedo = np.array([[[0.2, 0.9, 1.0, 0.5], [150.0, 0.0, np.nan, 1.0]]], np.float32)
    np.testing.assert_array_equal(reflected(albedo), np.array([[[0.2, 0.9, 1.0], [1.0, 0.0, np.nan]]], np.float32))


def test_motion_points_down_and_back() -> None:
    """What moved right by 1 and up by 2 was left of here, and below; it will be right of here, and above."""
    vector = np.array([[[1.0, 2.0, 9.0]]], np.float32)
    np.testing.assert_array_equal(against_time(vector), [[[-1.0, 2.0]]])
    np.testing.assert_array_equal(along_time(vector), [[[1.0, -2.0]]])
    np.testing.assert_array_equal(y_down(-vector), against_time(vector))


@given(st.integers(0, 2**32 - 1))
def test_a_hash_keeps_its_bits_even_where_they_are_no_number(number: int) -> None:
    rank = np.full((1, 1), number, np.uint32).view(np.float32)
    layer = np.stack([rank, np.ones_like(rank), rank, rank], axis=-1)
    assert hashes(layer) == number
