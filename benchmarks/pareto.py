"""The Pareto front: what nothing else beats in time and in error at once."""

from __future__ import annotations

from collections.abc import Sequence


def pareto_front(points: Sequence[tuple[float, float]]) -> list[int]:
    """Find the points that no other dominates, less being better in both coordinates.

    Parameters
    ----------
    points : sequence of (float, float)
        Time and error.

    Returns
    -------
    list of int
        Indices into `points`, by rising time. Equal points are all on the front or none is.
    """

    def dominated(time: float, error: float) -> bool:
        return any(t <= time and e <= error and (t, e) != (time, error) for t, e in points)

    front = [index for index, point in enumerate(points) if not dominated(*point)]
    return sorted(front, key=lambda index: points[index])
