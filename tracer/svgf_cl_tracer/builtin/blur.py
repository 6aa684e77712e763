"""A chess board seen through a wide lens: one pixel shows near and far points, at several moments."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..camera import Camera, CameraPath, Vector
from ..motion import Motion
from ..scene import Scene
from .patterns import planks, tiles
from .shapes import Outline, curve, lathe, panel, quad
from .surfaces import glazed, lamp, painted

# Forsyth-Edwards notation, from black's side down to white's.
POSITION = "1r3bk1/5ppp/2p5/4p3/p2P4/1PB5/5PPP/5RK1"

EYE: Vector = (-2.2, 2.0, 6.4)


def make() -> Scene:
    """The black queen shoots across the board while the focus rests on a pawn; lights far behind become discs."""
    board = tiles(8, 8, (74, 44, 28), (206, 170, 118), (60, 36, 24))
    white, black = glazed((0.78, 0.66, 0.46)), glazed((0.035, 0.022, 0.018))
    move = Motion.sliding((0.2, 0.8), ((3.5, 0.0, -1.5), (-3.5, 0.0, -1.5)))
    instances = [
        quad((-12, -0.02, 8), (24, 0, 0), (0, 0, -16), painted(planks(8, (52, 30, 18), (98, 60, 36))), repeat=(2, 2)),
        quad((-4, 0, 4), (8, 0, 0), (0, 0, -8), painted(board)),
        panel((-5.0, 7.0, 3.0), (0.0, 0.0, 0.0), (4.0, 3.0), lamp(34, 32, 29)),
        lathe(OUTLINES["q"], black, (0.0, 0.0, 0.0), motion=move),
        *(lathe(OUTLINES[piece.lower()], white if piece.isupper() else black, foot) for piece, foot in _pieces()),
    ]
    random = np.random.default_rng(19)
    for _ in range(28):
        x, y = random.uniform((-11.0, 0.3), (11.0, 4.6))
        glow = lamp(*random.uniform((30, 5, 1), (50, 34, 18)))
        instances.append(panel((x, y, -14.0), EYE, (0.1, 0.1), glow))
    camera = Camera(EYE, (-0.5, 0.6, 0.5), fov_y=36.0, aperture=0.35, shutter=0.5)
    return Scene(instances, sky=(0.02, 0.025, 0.04), camera_path=CameraPath.static(camera))


def _pieces() -> Iterator[tuple[str, Vector]]:
    """Each piece of the position and its place; a square is 1 wide."""
    for row, rank in enumerate(POSITION.split("/")):
        column = 0
        for symbol in rank:
            if symbol.isdigit():
                column += int(symbol)
            else:
                yield symbol, (column - 3.5, 0.0, row - 3.5)
                column += 1


def _turned(neck: float, *head: tuple[float, float]) -> Outline:
    """The outline of a piece: the foot, the stem up to the neck, a collar, and the head."""
    foot = [(0.0, 0.0), (0.36, 0.0), (0.36, 0.10), (0.28, 0.16)]
    stem = curve([(0.30, 0.20), (0.14, 0.2 + 0.4 * neck), (0.11, neck)])
    return [*foot, *stem, (0.2, neck + 0.04), *curve([(0.11, neck + 0.08), *head])]


OUTLINES = {
    "p": _turned(0.68, (0.19, 0.90), (0.15, 1.02), (0.0, 1.08)),
    "r": _turned(0.76, (0.22, 0.92), (0.24, 1.16), (0.17, 1.16), (0.0, 1.06)),
    "b": _turned(0.98, (0.18, 1.22), (0.10, 1.44), (0.03, 1.5), (0.0, 1.58)),
    "q": _turned(1.28, (0.14, 1.55), (0.22, 1.72), (0.06, 1.82), (0.0, 1.92)),
    "k": _turned(1.36, (0.15, 1.66), (0.23, 1.84), (0.05, 1.92), (0.07, 2.02), (0.0, 2.1)),
}
