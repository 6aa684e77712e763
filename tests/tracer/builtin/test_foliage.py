from __future__ import annotations

import numpy as np

from svgf_cl_tracer.builtin.foliage import SIDE, foliage, twigs


def test_cards_are_squares_within_their_ellipsoid() -> None:
    leaves = foliage(200, (1.0, 2.0, 3.0), (2.0, 1.0, 0.5), seed=1)
    assert leaves.corners.shape == (400, 3, 3)
    edge = leaves.corners[::2, 1] - leaves.corners[::2, 0]
    np.testing.assert_allclose(np.linalg.norm(edge, axis=1), SIDE)
    middle = (leaves.corners[::2, 0] + leaves.corners[::2, 2]) / 2.0
    distance = np.linalg.norm((middle - (1.0, 2.0, 3.0)) / (2.0, 1.0, 0.5), axis=1)
    assert distance.max() <= 1.0
    assert distance.min() > 0.5


def test_a_seed_makes_the_same_leaves_again() -> None:
    one, same, other = (foliage(5, (0, 0, 0), (1, 1, 1), seed=seed).corners for seed in (1, 1, 2))
    np.testing.assert_array_equal(one, same)
    assert not np.array_equal(one, other)


def test_one_sees_through_between_green_leaves() -> None:
    picture = twigs()
    solid = picture[..., 3] == 255
    assert 0.2 < solid.mean() < 0.7
    assert (picture[~solid] == 0).all()
    red, green, blue = picture[solid][:, :3].mean(0)
    assert green > red > blue
