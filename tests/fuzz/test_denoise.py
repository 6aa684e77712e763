"""Whatever `denoise` is given it gives a finite picture of the right shape, or an error that says what is wrong."""

from __future__ import annotations

import numpy as np
import pyopencl as cl
import pyopencl.array as cl_array
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_array_equal

from svgf_cl import Denoiser, Settings, SvgfError
from svgf_cl.frame import Shape
from svgf_cl.settings import CHOICES, RANGES
from tests.frames import FULL, TINY
from tests.fuzz import calls
from tests.fuzz.effort import effort


def fetched(out: np.ndarray | cl_array.Array) -> np.ndarray:
    return out.get() if isinstance(out, cl_array.Array) else out


def assert_is_a_picture(out: np.ndarray, shape: Shape) -> None:
    assert out.shape == (*shape, 3)
    assert out.dtype == np.float32
    assert np.isfinite(out).all()


@effort(8)
@given(
    data=st.data(),
    shape=calls.shapes,
    names=calls.fields(),
    motion=st.sampled_from((2, 3)),
    wild=st.booleans(),
    seed=calls.seeds,
)
def test_how_arrays_are_held_does_not_matter(
    queue: cl.CommandQueue,
    data: st.DataObject,
    shape: Shape,
    names: tuple[str, ...],
    motion: int,
    wild: bool,
    seed: int,
) -> None:
    den, other = Denoiser(shape, queue=queue), Denoiser(shape)
    for turn in range(2):
        frame = calls.frame_of(seed + turn, shape, names, motion, wild=wild)
        held = data.draw(calls.held_somehow(frame, queue, on_device=data.draw(st.sampled_from((None, True, False)))))
        out = fetched(den.denoise(held))
        assert_is_a_picture(out, shape)
        assert_array_equal(out, other.denoise(calls.plain(held)))


def numbers(name: str) -> st.SearchStrategy[float]:
    """A setting's ends, and what lies between."""
    low, high = RANGES[name]
    if isinstance(getattr(Settings(), name), int):
        return st.integers(int(low), int(high))
    return st.sampled_from((low, high)) | st.floats(low, high)


settings = st.builds(
    Settings,
    **{name: numbers(name) for name in RANGES},
    **{name: st.sampled_from(choices) for name, choices in CHOICES.items()},
    **{name: st.booleans() for name in ("taa", "half_guides", "half_history")},
)


@effort(8)
@given(chosen=settings, shape=calls.shapes, wild=st.booleans(), seed=calls.seeds)
def test_any_settings_give_a_picture(chosen: Settings, shape: Shape, wild: bool, seed: int) -> None:
    den = Denoiser(shape, settings=chosen)
    for turn in range(3):
        assert_is_a_picture(den.denoise(calls.frame_of(seed + turn, shape, FULL, 3, wild=wild)), shape)


@effort()
@given(data=st.data(), names=calls.fields(), seed=calls.seeds)
def test_a_wrong_call_is_refused_by_name_and_leaves_no_trace(
    queue: cl.CommandQueue, data: st.DataObject, names: tuple[str, ...], seed: int
) -> None:
    frame = calls.frame_of(seed, TINY, names, 3, wild=False)
    den = Denoiser(TINY, queue=queue)
    wrong = data.draw(calls.wrong_calls(frame, queue))
    name = rf"(Frame\.{wrong.what}|denoise\({wrong.what}\))"
    with pytest.raises(SvgfError, match=rf"^{name}: expected [^\n]+, got [^\n]+$"):
        den.denoise(**wrong.arguments)
    assert_array_equal(den.denoise(frame), Denoiser(TINY).denoise(frame))
