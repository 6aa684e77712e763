"""Depth from 1e-6 to 1e9 scene units, in one picture or from scene to scene: as exact as at an arm's length."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from svgf_cl import Frame
from tests.frames import SHAPE, bumpy_sequence
from tests.hard.variants import Variant, on

# Depth goes into weights, and into what TAA calls the foremost; it is kept in 32 bits whatever the storage.
variants = on("precise", "precise, two signals, TAA", "fast", "Kalman")

NEAREST, FARTHEST = 1e-6, 1e9


def at_depths(frame: Frame, depth: np.ndarray) -> Frame:
    """The frame with its hits at these depths, (H, W); its expected change of depth, a few percent, in proportion."""
    seen = np.isfinite(frame.depth)
    motion = frame.motion * np.stack((*np.ones((2, *SHAPE)), np.where(seen, depth / 4, 0)), axis=-1)
    return replace(frame, depth=np.where(seen, depth, np.inf), motion=motion)


def receding(rng: np.random.Generator) -> np.ndarray:
    """A floor from the lens to the horizon, with a faint relief."""
    share = np.linspace(0, 1, SHAPE[1])
    return NEAREST * (FARTHEST / NEAREST) ** share * rng.uniform(0.999, 1.001, SHAPE)


def scattered(rng: np.random.Generator) -> np.ndarray:
    """Every pixel a thing of its own, anywhere: no pixel says anything about the slope at its neighbour."""
    return np.exp(rng.uniform(np.log(NEAREST), np.log(FARTHEST), SHAPE))


def two_layers(rng: np.random.Generator) -> np.ndarray:
    """Specks on the lens in front of mountains."""
    return np.where(rng.random(SHAPE) < 0.5, NEAREST, FARTHEST)


@pytest.mark.parametrize("depths", [receding, scattered, two_layers])
@variants
def test_all_in_one_picture(variant: Variant, depths: Callable[[np.random.Generator], np.ndarray]) -> None:
    rng = np.random.default_rng(7)
    frames = bumpy_sequence(variant.fields)
    variant.assert_follows_oracle([at_depths(frame, depths(rng)) for frame in frames])
