"""Whatever frames hold, checks come to an end, without a word on the way."""

from __future__ import annotations

import warnings

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from svgf_cl import Frame, check_sequence
from tests.frames import bumpy
from tests.fuzz import calls
from tests.fuzz.effort import effort

VALUES = np.array([0, 1, -1, 1e-45, 1e-30, 1e10, 1e20, 3e38, -3e38, np.nan, np.inf, -np.inf], np.float32)


def anything(rng: np.random.Generator, name: str, value: np.ndarray) -> np.ndarray:
    """Values of a field: as they were, any bits, extremes, one of these everywhere, or of any magnitude."""
    if name == "id":
        return calls.any_bits(rng, value)
    magnitude = np.float32(10.0 ** rng.integers(-38, 38))
    choices = (
        value,
        calls.any_bits(rng, value),
        rng.choice(VALUES, value.shape),
        np.full_like(value, rng.choice(VALUES)),
        rng.random(value.shape, np.float32) * magnitude,
    )
    return choices[rng.integers(len(choices))]


def frame_of(rng: np.random.Generator, shape: tuple[int, int]) -> Frame:
    return calls.mapped(bumpy(rng, shape), lambda name, value: anything(rng, name, value))


@effort(40)
@given(seed=calls.seeds, shape=st.sampled_from([(1, 1), (2, 3), (7, 9), (40, 60)]))
def test_any_frames_are_checked(seed: int, shape: tuple[int, int]) -> None:
    rng = np.random.default_rng(seed)
    with np.errstate(all="ignore"):
        frames = [frame_of(rng, shape) for _ in range(3)]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_sequence(frames)
