from __future__ import annotations

import numpy as np

from tracer.vectors import dot, normalise


def test_dot_works_column_by_column() -> None:
    a = np.array([[1.0, 0.0], [2.0, 1.0], [3.0, 0.0]])
    np.testing.assert_array_equal(dot(a, a), (14.0, 1.0))


def test_normalise_leaves_nothing_at_zero() -> None:
    vectors = np.array([[3.0, 0.0], [0.0, 0.0], [4.0, 0.0]], np.float32)
    np.testing.assert_allclose(normalise(vectors), [[0.6, 0.0], [0.0, 0.0], [0.8, 0.0]], rtol=1e-6)
