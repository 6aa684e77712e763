"""Kernels and filter on path-traced frames: every stage follows the float64 oracle as closely as on made-up ones."""

from __future__ import annotations

from functools import partial
from typing import Any

import pytest

from svgf_cl import Denoiser, Eaw, Settings
from svgf_cl.oracle.svgf import Oracle
from tests.frames import FULL, SPLIT
from tests.kernels import test_eaw
from tests.kernels.test_storage import BOUNDS
from tests.oracle import Case, assert_follows_oracle, error_to_oracle
from tests.svgf_cl.test_denoiser import assert_alike
from tests.tracer.frames import traced_sequence

CASES = {
    "traced": Case(partial(traced_sequence, FULL), Settings(taps="5x5")),
    "traced, antialiased": Case(partial(traced_sequence, SPLIT), Settings(taa=True, taps="5x5")),
    "traced, EAW": Case(partial(traced_sequence, SPLIT), Eaw(taa=True, taps="5x5")),
}
FULL_FRAMES = partial(traced_sequence, FULL)


@pytest.mark.parametrize("case", CASES)
def test_follows_the_oracle(case: str) -> None:
    assert_follows_oracle(CASES[case])


@pytest.mark.parametrize(("choice", "bound"), test_eaw.BOUNDS, ids=["halves", "fast", "halves and fast"])
def test_error_of_what_saves_time_or_memory_in_eaw(choice: dict[str, Any], bound: float) -> None:
    assert error_to_oracle(FULL_FRAMES, Eaw(sigma_color=4), **choice) <= bound


@pytest.mark.parametrize(("choice", "bound"), BOUNDS, ids=[" ".join(choice) or "precise" for choice, _ in BOUNDS])
def test_error_of_what_saves_time_or_memory(choice: dict[str, Any], bound: float) -> None:
    assert error_to_oracle(FULL_FRAMES, Settings(), **choice) <= bound


@pytest.mark.parametrize(("fields", "chosen"), [(FULL, Settings()), (SPLIT, Settings(taa=True))], ids=["full", "split"])
def test_errors_do_not_build_up_over_a_sequence(fields: tuple[str, ...], chosen: Settings) -> None:
    frames = traced_sequence(fields, count=8)
    den, oracle = Denoiser(frames[0].shape, settings=chosen), Oracle(frames[0].shape, chosen)
    for frame in frames:
        assert_alike(den.denoise(frame), oracle.denoise(frame))
