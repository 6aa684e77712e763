"""Small scenes: the oracles are slow."""

from __future__ import annotations

from typing import Any

import numpy as np

from svgf_cl.frame import Frame, Shape
from svgf_cl.oracle.temporal import Guides, demodulate
from tests import frames
from tests.frames import FACING

SHAPE = (12, 14)


def wall(shape: Shape = SHAPE, **given: Any) -> Frame:
    """`frames.wall`, smaller."""
    return frames.wall(shape, **given)


def bumpy(rng: np.random.Generator, shape: Shape = SHAPE, misses: float = 0.1, **given: Any) -> Frame:
    """Random light, albedo, motion and a rough surface with holes."""
    hit = rng.random(shape) >= misses
    random = {
        "color": rng.random((*shape, 3)),
        "albedo": rng.random((*shape, 3)),
        "normal": (FACING + rng.normal(0, 0.1, (*shape, 3))) * hit[..., None],
        "depth": np.where(hit, rng.uniform(4, 5, shape), np.inf),
        "motion": rng.uniform(-1, 1, (*shape, 3)) * (1, 1, 0.05),
    }
    return wall(shape, **(random | given))


def guides_of(frame: Frame) -> Guides:
    return demodulate(frame)[1]
