"""What filters may be asked for, for property tests."""

from __future__ import annotations

from hypothesis import strategies as st

from svgf_cl import Eaw, Inputs, Kalman, Settings
from svgf_cl.filters.signals import SPLITS

every_inputs = st.builds(
    Inputs,
    signals=st.sampled_from(SPLITS),
    motion=st.sampled_from((2, 3)),
    albedo=st.booleans(),
    emission=st.booleans(),
    id=st.booleans(),
)
chosen = {
    "iterations": st.integers(1, 5),
    "taa": st.booleans(),
    "half_guides": st.booleans(),
    "half_history": st.booleans(),
}
more_levels = {"iterations": st.integers(2, 5)}  # of a single one, nobody reads the guidance of the others
every_filter = st.one_of(
    st.builds(Settings, **chosen), st.builds(Eaw, **chosen), st.builds(Kalman, **chosen | more_levels)
)
every_pipeline = st.builds(lambda filter_, inputs: filter_.pipeline(inputs), every_filter, every_inputs)
