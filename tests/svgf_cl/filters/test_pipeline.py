"""The pass table: everything read was written before, and everything written is read."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from svgf_cl import Settings
from svgf_cl.filters.pipeline import HISTORY, OUT, PREVIOUS, Inputs, history_pairs, kind_of, pipeline
from tests.frames import FULL, PLAIN, SPLIT, bumpy, only

every_inputs = st.builds(
    Inputs,
    signals=st.sampled_from((1, 2)),
    motion=st.sampled_from((2, 3)),
    albedo=st.booleans(),
    emission=st.booleans(),
    id=st.booleans(),
)
every_settings = st.builds(Settings, iterations=st.integers(1, 5), taa=st.booleans())


@pytest.mark.parametrize(
    ("fields", "motion", "expected"),
    [
        (PLAIN, 2, Inputs(signals=1, motion=2, albedo=False, emission=False, id=False)),
        (FULL, 3, Inputs(signals=1, motion=3, albedo=True, emission=True, id=True)),
        (SPLIT, 3, Inputs(signals=2, motion=3, albedo=True, emission=True, id=True)),
        ((*SPLIT, "color"), 3, Inputs(signals=2, motion=3, albedo=True, emission=True, id=True)),
    ],
)
def test_inputs_are_the_frames_fields(fields: tuple[str, ...], motion: int, expected: Inputs) -> None:
    inputs = Inputs.of(only(bumpy(np.random.default_rng(0)), fields, motion))
    assert inputs == expected
    assert set(inputs.fields) == {"normal", "depth", "motion", *fields} - ({"color"} if inputs.signals == 2 else set())


@given(every_inputs, every_settings)
def test_names_are_unique(inputs: Inputs, settings: Settings) -> None:
    names = [step.name for step in pipeline(inputs, settings)]
    assert len(set(names)) == len(names)


@given(every_inputs, every_settings)
def test_everything_read_is_there(inputs: Inputs, settings: Settings) -> None:
    passes = pipeline(inputs, settings)
    there = {*inputs.fields, *HISTORY, *(PREVIOUS + name for name in history_pairs(passes))}  # from the last frame
    for step in passes:
        assert there.issuperset(step.reads)
        there |= set(step.writes)
    assert OUT in passes[-1].writes


def passes_writes(passes: tuple) -> set[str]:
    return {name for step in passes for name in step.writes}


@given(every_inputs, every_settings)
def test_every_field_and_every_result_is_read(inputs: Inputs, settings: Settings) -> None:
    passes = pipeline(inputs, settings)
    reads = {name.removeprefix("previous ") for step in passes for name in step.reads}
    assert reads == {*inputs.fields, *passes_writes(passes)} - {OUT}


@given(every_inputs, st.integers(1, 5), st.booleans())
def test_levels_double_their_step(inputs: Inputs, iterations: int, taa: bool) -> None:
    passes = pipeline(inputs, Settings(iterations=iterations, taa=taa))
    assert [step.step for step in passes if step.kernel == "atrous"] == [2**level for level in range(iterations)]


def test_first_level_writes_the_colour_history() -> None:
    (first,) = [step for step in pipeline(Inputs(1, 2, False, False, False), Settings()) if step.name == "atrous 1"]
    assert first.writes == ("history",)


@pytest.mark.parametrize(
    ("buffer", "kind"), [("guide", "guide"), ("previous guide", "guide"), ("level 2", "level"), ("out", "out")]
)
def test_kinds_of_buffers(buffer: str, kind: str) -> None:
    assert kind_of(buffer) == kind
