"""The Pareto front is what nothing else beats."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from benchmarks.pareto import pareto_front

POINTS = st.lists(st.tuples(st.integers(0, 9), st.integers(0, 9)), max_size=20)


def test_the_front_of_known_points() -> None:
    # The second is slower and worse than the first; the third buys error with time; the last is only slower.
    assert pareto_front([(1, 5), (2, 6), (3, 2), (4, 2)]) == [0, 2]


def test_equal_points_stand_together() -> None:
    assert pareto_front([(2, 1), (1, 1), (1, 1)]) == [1, 2]


@given(POINTS)
def test_whatever_is_off_the_front_is_beaten_by_something_on_it(points: list[tuple[int, int]]) -> None:
    front = pareto_front(points)
    assert front or not points
    for index, (time, error) in enumerate(points):
        beaten = [i for i in front if points[i] != (time, error) and points[i][0] <= time and points[i][1] <= error]
        assert bool(beaten) == (index not in front)
