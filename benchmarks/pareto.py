"""The Pareto front: points that no other point beats in both time and error."""

from __future__ import annotations

from collections.abc import Sequence


def pareto_front(points: Sequence[tuple[float, float]]) -> list[int]:
    """Find the points that no other point dominates; less is better in both coordinates.

    Parameters
    ----------
    points : sequence of (float, float)
        Time and error.

    Returns
    -------
    list of int
        Indices into `points`, by rising time. Of equal points, either all or none are on the front.
    """

    def dominated(time: float, error: float) -> bool:
        return any(t <= time and e <= error and (t, e) != (time, error) for t, e in points)

    front = [index for index, point in enumerate(points) if not dominated(*point)]
    return sorted(front, key=lambda index: points[index])
