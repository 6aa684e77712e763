"""Planes in 32 and in 16 bits: how much they are, and what their elements stand for."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from svgf_cl.filters.formats import HALF_MAX, SNORM_MAX, Format, Planes


@pytest.mark.parametrize(("planes", "bits"), [(Planes(3), 96), (Planes(0, 3), 48), (Planes(1, 3), 80)])
def test_depth(planes: Planes, bits: int) -> None:
    assert planes.depth == bits


def test_over_has_room_for_either() -> None:
    assert Planes(1, 4).over(Planes(2, 3)) == Planes(2, 4)


@pytest.mark.parametrize(("planes", "mixed"), [(Planes(3), False), (Planes(0, 3), False), (Planes(1, 3), True)])
def test_mixed(planes: Planes, mixed: bool) -> None:
    assert planes.is_mixed == mixed


@pytest.mark.parametrize(
    ("format_", "elements", "expected"),
    [
        (Format.FLOAT, [0.5, -2.0], [0.5, -2.0]),
        (Format.SNORM, [SNORM_MAX, -SNORM_MAX], [1.0, -1.0]),
        (Format.HALF, [0.5, HALF_MAX], [0.5, HALF_MAX]),
        (Format.ROOT, [0.5, HALF_MAX], [0.25, HALF_MAX**2]),
    ],
)
def test_decoding(format_: Format, elements: list[float], expected: list[float]) -> None:
    stored = np.array(elements, format_.dtype)
    found = format_.decoded(stored)
    assert found.dtype == np.float32
    assert_allclose(found, expected)
    assert not np.shares_memory(found, stored)
    assert format_.nbytes == stored.itemsize


@pytest.mark.parametrize("format_", Format)
@pytest.mark.parametrize("value", [0.0, 0.25, 1.0])
def test_encoding_is_the_way_back(format_: Format, value: float) -> None:
    element = format_.encoded(value)
    assert (element.dtype, element.shape) == (format_.dtype, ())
    assert_allclose(format_.decoded(element), value, atol=1 / SNORM_MAX)


def test_the_greatest_16_bit_float_is_numpys() -> None:
    assert_array_equal(HALF_MAX, np.finfo(np.float16).max)
