"""Leaves cut out of cards: a texture with opacity, and objects that consist of many such cards."""

from __future__ import annotations

import numpy as np

from ..camera import Vector
from ..geometry import Instance
from ..materials import Material
from ..textures import Image
from .patterns import image
from .shapes import SQUARE

SIDE = 0.26  # side of a card


def foliage(count: int, centre: Vector, half_axes: Vector, *, seed: int) -> Instance:
    """`count` twigs in an ellipsoid, turned at random, most of them near its surface."""
    random = np.random.default_rng(seed)
    direction = random.standard_normal((count, 3))
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    middle = np.array(centre) + direction * half_axes * np.sqrt(random.uniform(0.35, 1.0, (count, 1)))
    axes = SIDE * np.linalg.qr(random.standard_normal((count, 3, 2)))[0]
    # (card, triangle, corner, axis) times (card, (x, y, z), axis)
    corners = middle[:, None, None] + np.einsum("tca,nxa->ntcx", SQUARE - 0.5, axes)
    twig = Material(base_texture=twigs(), alpha_cutoff=0.5)
    return Instance(corners.reshape(-1, 3, 3), twig, uv=np.tile(SQUARE, (count, 1, 1)))


def twigs() -> Image:
    """Seven leaves around a point (h, w, 4); the fourth channel is 0 outside the leaves."""
    size = 128
    y, x = np.mgrid[-1.0 : 1.0 : size * 1j, -1.0 : 1.0 : size * 1j]
    picture = np.zeros((size, size, 4))
    random = np.random.default_rng(9)
    for turn in np.linspace(0.0, 2.0 * np.pi, 7, endpoint=False):
        along, across = x * np.cos(turn) + y * np.sin(turn), y * np.cos(turn) - x * np.sin(turn)
        leaf = abs(across) < 0.9 * (along - 0.1) * (0.95 - along)
        green = np.array((74, 118, 38)) * random.uniform(0.75, 1.25)
        vein = 30.0 * (abs(across[leaf]) < 0.02)
        picture[leaf, :3], picture[leaf, 3] = green + vein[:, None], 255
    return image(picture)
