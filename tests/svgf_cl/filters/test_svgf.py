"""SVGF as a pipeline."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from svgf_cl import Inputs, Settings
from svgf_cl.filters.pipeline import Buffer, Life
from tests.svgf_cl.filters.strategies import every_inputs


@given(every_inputs, st.integers(1, 5), st.booleans())
def test_levels_double_their_step(inputs: Inputs, iterations: int, taa: bool) -> None:
    passes = Settings(iterations=iterations, taa=taa).pipeline(inputs).passes
    steps = [entry.scalars["step"] for entry in passes if entry.kernel == "atrous"]
    assert steps == [2**level for level in range(iterations)]


def test_first_level_writes_the_colour_history() -> None:
    passes = {entry.label: entry for entry in Settings().pipeline(Inputs()).passes}
    (written,) = passes["atrous 1"].writes
    (read,) = [each for each in passes["temporal"].reads if each.argument == "history"]
    assert isinstance(written.of, Buffer)
    assert written.of == read.of
    assert written.of.resource.life is Life.HISTORY


def test_no_number_compiles_anew() -> None:
    numbers = Settings(sigma_depth=1e3, sigma_normal=1024, sigma_luminance=1e3, alpha_color=1, alpha_taa=1)
    assert numbers.pipeline(Inputs()).defines == Settings().pipeline(Inputs()).defines
    chosen = Settings(taa=True, precision="fast", taps="5x5", half_guides=True, half_history=True).macros
    assert chosen == {"TAA": 1, "FAST": 1, "RADIUS": 2, "HALF_GUIDES": 1, "HALF_HISTORY": 1}


def test_a_whole_number_for_a_float_is_a_float() -> None:
    scalars = [entry.scalars for entry in Settings(sigma_depth=2).pipeline(Inputs()).passes if entry.level == 1]
    assert [type(each["sigma_depth"]) for each in scalars] == [float]
    assert [type(each["step"]) for each in scalars] == [int]
