"""Whatever `denoise` is given it gives a finite picture of the right shape, or an error that says what is wrong."""

from __future__ import annotations

import numpy as np
import pyopencl as cl
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_array_equal

from svgf_cl import Denoiser, Eaw, SvgfError
from svgf_cl.device.tuning import VECTOR_WIDTHS
from svgf_cl.filters import FILTERS
from svgf_cl.filters.filter import Filter
from svgf_cl.frame import Shape
from svgf_cl.settings import Choice, Domain, Range, Value, domains
from tests.arrays import fetched
from tests.denoising import vector_width
from tests.frames import FULL, PLAIN, SPLIT, TINY
from tests.fuzz import calls
from tests.fuzz.effort import effort

QUICKEST = Eaw(iterations=1)  # to compile, where the filter does not matter


def assert_is_a_picture(out: np.ndarray, shape: Shape) -> None:
    assert out.shape == (*shape, 3)
    assert out.dtype == np.float32
    assert np.isfinite(out).all()


@effort(5)
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
    den, other = Denoiser(shape, settings=QUICKEST, queue=queue), Denoiser(shape, settings=QUICKEST)
    for turn in range(2):
        frame = calls.frame_of(seed + turn, shape, names, motion, wild=wild)
        held = data.draw(calls.held_somehow(frame, queue, on_device=data.draw(st.sampled_from((None, True, False)))))
        out = fetched(den.denoise(held))
        assert_is_a_picture(out, shape)
        assert_array_equal(out, other.denoise(calls.plain(held)))


def values(domain: Domain) -> st.SearchStrategy[Value]:
    """All that a setting may be; of a number its ends, and what lies between."""
    if isinstance(domain, Choice):
        return st.sampled_from(domain.words)
    if isinstance(domain, Range):
        low, high = domain.least, domain.greatest
        return st.integers(int(low), int(high)) if domain.whole else st.sampled_from((low, high)) | st.floats(low, high)
    return st.booleans()


def any_settings(of: type[Filter]) -> st.SearchStrategy[Filter]:
    every = st.fixed_dictionaries({name: values(domain) for name, domain in domains(of).items()})
    return every.map(lambda chosen: of(**chosen if chosen["taa"] else chosen | {"pixel_filter": 0.0}))


@pytest.mark.parametrize("name", FILTERS)
@effort(2)
@given(data=st.data(), shape=calls.shapes, seed=calls.seeds)
def test_any_settings_give_a_picture(name: str, data: st.DataObject, shape: Shape, seed: int) -> None:
    """Of usual frames and of wild ones, as both take the same kernels, and building these takes the time."""
    chosen = data.draw(any_settings(FILTERS[name]))
    with vector_width(data.draw(st.sampled_from(VECTOR_WIDTHS))):
        denoisers = {wild: Denoiser(shape, settings=chosen) for wild in (False, True)}
    for wild, den in denoisers.items():
        for turn in range(3):
            assert_is_a_picture(den.denoise(calls.frame_of(seed + turn, shape, FULL, 3, wild=wild)), shape)


@effort()
@given(data=st.data(), names=st.sampled_from((PLAIN, (*SPLIT, "color", "roughness"))), seed=calls.seeds)
def test_a_wrong_call_is_refused_by_name_and_leaves_no_trace(
    queue: cl.CommandQueue, data: st.DataObject, names: tuple[str, ...], seed: int
) -> None:
    frame = calls.frame_of(seed, TINY, names, 3, wild=False)
    den = Denoiser(TINY, settings=QUICKEST, queue=queue)
    wrong = data.draw(calls.wrong_calls(frame, queue))
    name = rf"(Frame\.{wrong.what}|denoise\({wrong.what}\))"
    with pytest.raises(SvgfError, match=rf"^{name}: expected [^\n]+, got [^\n]+$"):
        den.denoise(**wrong.arguments)
    assert_array_equal(den.denoise(frame), Denoiser(TINY, settings=QUICKEST).denoise(frame))
