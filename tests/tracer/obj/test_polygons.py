from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from svgf_cl_tracer.obj.polygons import triangulate

L = [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]
COMB = [(0, 0), (5, 0), (5, 3), (4, 3), (4, 1), (3, 1), (3, 3), (2, 3), (2, 1), (1, 1), (1, 3), (0, 3)]
DART = [(0, 0), (2, 0), (0.5, 0.5), (0, 2)]
ARROW = [(0, 0), (1, 1), (0, 4), (-1, 1), (0, 2)]
STRAIGHT = [(0, 0), (1, 0), (2, 0), (2, 1), (2, 2), (1, 2), (0, 2), (0, 1)]
TWICE = [(0, 0), (2, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2), (0, 0)]
# A square with a square hole, cut open between them.
HOLE = [(0, 0), (3, 0), (3, 3), (0, 3), (0, 0), (1, 1), (1, 2), (2, 2), (2, 1), (1, 1)]


def area(points: np.ndarray) -> np.ndarray:
    """The area of a polygon, as a vector along its normal."""
    return np.cross(points[1:-1] - points[0], points[2:] - points[0]).sum(0) / 2


def in_space(polygon: list[tuple[float, float]], seed: int) -> np.ndarray:
    """The polygon somewhere in space, turned anyhow."""
    rng = np.random.default_rng(seed)
    axes = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    return np.array(polygon, float) @ axes[:2] + rng.normal(size=3)


def assert_covered_once(points: np.ndarray) -> None:
    triangles, _ = triangulate(points, np.array([len(points)]))
    whole = area(points)
    parts = np.array([area(points[triangle]) for triangle in triangles])
    np.testing.assert_allclose(parts.sum(0), whole, atol=1e-9)
    # As the parts have the area of the whole, none covers what another one does.
    assert (parts @ whole >= -1e-9).all()


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("polygon", [L, COMB, DART, ARROW, STRAIGHT, TWICE, HOLE])
def test_every_corner_may_come_first_and_either_side_be_the_front(polygon: list, seed: int) -> None:
    for first in range(len(polygon)):
        for turned in (polygon, polygon[::-1]):
            assert_covered_once(in_space(turned[first:] + turned[:first], seed))


@settings(max_examples=60)
@given(st.lists(st.floats(0.1, 10.0), min_size=4, max_size=40), st.integers(0, 99))
def test_stars_with_any_rays(radii: list[float], seed: int) -> None:
    angles = np.linspace(0, 2 * np.pi, len(radii), endpoint=False)
    assert_covered_once(in_space([(r * np.cos(a), r * np.sin(a)) for r, a in zip(radii, angles, strict=True)], seed))


def test_polygons_of_all_sizes_keep_their_order_and_their_corners() -> None:
    polygons = [in_space(polygon, 1) for polygon in (L, L[:3], DART, COMB, STRAIGHT[:4], L)]
    counts = np.array([len(polygon) for polygon in polygons])
    triangles, owners = triangulate(np.concatenate(polygons), counts)
    assert (np.diff(owners) >= 0).all()
    starts = np.cumsum(counts) - counts
    assert (triangles >= starts[owners, None]).all()
    assert (triangles < (starts + counts)[owners, None]).all()
    assert np.bincount(owners).tolist() == [4, 1, 2, 10, 2, 4]


def test_a_polygon_without_area_is_no_error() -> None:
    points = np.zeros((6, 3))
    points[:, 0] = range(6)
    assert triangulate(points, np.array([6]))[0].shape == (4, 3)
    assert triangulate(np.zeros((0, 3)), np.zeros(0, np.int64))[0].shape == (0, 3)
