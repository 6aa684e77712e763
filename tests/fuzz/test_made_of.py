"""Whatever a denoiser, its settings or its tuning are made of: they are made, or an error says what was expected."""

from __future__ import annotations

from dataclasses import fields
from decimal import Decimal
from fractions import Fraction
from typing import Any

import numpy as np
import pyopencl as cl
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from svgf_cl import Denoiser, Settings, SettingsError, SvgfError, Tuning
from svgf_cl.device.layout import Layout
from svgf_cl.filters.signals import Inputs
from tests.fuzz.effort import effort

anything = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(),
    st.sampled_from((10**5000, -(10**5000), np.int64(3), np.float16(0.5), np.nan, np.True_)),
    st.floats(),
    st.complex_numbers(),
    st.text(),
    st.binary(),
    st.builds(Fraction, st.integers(), st.integers(1)),
    st.sampled_from((Decimal("0.5"), Decimal("NaN"))),
    st.lists(st.integers(), max_size=3),
    st.tuples(st.integers(), st.integers()),
    st.sampled_from(("precise", "3x3")).map(lambda word: np.array([word, word])),
    st.builds(np.zeros, st.lists(st.integers(0, 2), max_size=3)),
    st.builds(object),
)


@effort()
@example(name="taps", value=np.array(["3x3", "3x3"]))
@example(name="iterations", value=10**5000)
@given(name=st.sampled_from([field.name for field in fields(Settings)]), value=anything)
def test_settings(name: str, value: Any) -> None:
    try:
        made = Settings(**{name: value})
    except SettingsError as error:
        refusal = str(error)
    else:
        assert np.isfinite(float(getattr(made, name))) if name not in ("taps", "precision") else getattr(made, name)
        return
    assert refusal.startswith(f"Settings.{name}: expected ")
    assert ", got " in refusal
    assert len(refusal) < 200


@effort()
@example(name="vector_width", value=4.0)
@example(name="row_alignment", value=64.0)
@given(name=st.sampled_from([field.name for field in fields(Tuning)]), value=anything)
def test_tuning(name: str, value: Any) -> None:
    right = {"vector_width": 4, "work_group": (16, 1)}
    try:
        made = Tuning(**{**right, name: value})
    except SvgfError as error:
        refusal = str(error)
    else:
        assert all(isinstance(number, int) for number in (made.vector_width, *made.work_group, made.row_alignment))
        return
    assert refusal.startswith(f"Tuning.{name}: expected ")
    assert len(refusal) < 200


@effort()
@given(name=st.sampled_from(("shape", "settings", "queue", "tuning")), value=anything)
def test_denoiser(queue: cl.CommandQueue, name: str, value: Any) -> None:
    right = {"shape": (2, 3), "queue": queue}
    if is_right(name, value):
        assert min(Denoiser(**{**right, name: value}).shape) >= 1
        return
    with pytest.raises(SvgfError, match=r"^Denoiser: expected .*, got "):
        Denoiser(**{**right, name: value})


def is_right(name: str, value: Any) -> bool:
    """Two whole numbers are a shape; all else may be left out."""
    if name != "shape":
        return value is None
    is_pair = isinstance(value, (tuple, list, bytes)) and len(value) == 2
    widest = Settings().pipeline(Inputs.every()).widest
    return is_pair and min(value) >= 1 and Layout(*value).indexable(widest)
