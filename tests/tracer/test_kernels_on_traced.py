"""Kernels and filter on path-traced frames: every stage follows the float64 oracle as closely as on made-up ones."""

from __future__ import annotations

from functools import partial
from typing import Any

import pytest

from svgf_cl import Denoiser, Eaw, Settings
from svgf_cl.oracle.svgf import Oracle
from tests.frames import FULL, SPLIT
from tests.kernels import test_eaw
from tests.kernels.test_storage import BOUNDS, error_to_the_oracle
from tests.oracle import TOLERANCES, Case, assert_case_follows_oracle
from tests.svgf_cl.test_denoiser import assert_alike
from tests.tracer.frames import traced_sequence

CASES = {
    "traced": Case(partial(traced_sequence, FULL), Settings(taps="5x5")),
    "traced, antialiased": Case(partial(traced_sequence, SPLIT), Settings(taa=True, taps="5x5")),
}
STAGES = {
    "modulate": ("normal", "depth", "demodulated", "modulated"),
    "temporal": ("accumulated", "history_length", "mean", "moment_variance"),
    "variance": ("variance",),
    "atrous": ("level", "level_variance"),
}


@pytest.mark.parametrize("kernel", STAGES)
@pytest.mark.parametrize("case", CASES)
def test_follows_the_oracle(case: str, kernel: str) -> None:
    assert_case_follows_oracle(CASES[case], *STAGES[kernel])


def test_eaw_follows_the_oracle() -> None:
    case = Case(partial(traced_sequence, SPLIT), Eaw(taa=True, taps="5x5"))
    assert_case_follows_oracle(case, *TOLERANCES)


@pytest.mark.parametrize(("choice", "bound"), test_eaw.BOUNDS, ids=["halves", "fast", "halves and fast"])
def test_error_of_what_saves_time_or_memory_in_eaw(choice: dict[str, Any], bound: float) -> None:
    assert test_eaw.error_to_the_oracle(traced_sequence(FULL), choice) <= bound


def test_antialiasing_follows_the_oracle() -> None:
    assert_case_follows_oracle(CASES["traced, antialiased"], "antialiased", "resolved")


@pytest.mark.parametrize(("choice", "bound"), BOUNDS, ids=[" ".join(choice) or "precise" for choice, _ in BOUNDS])
def test_error_of_what_saves_time_or_memory(choice: dict[str, Any], bound: float) -> None:
    assert error_to_the_oracle(traced_sequence(FULL), choice) <= bound


@pytest.mark.parametrize(("fields", "chosen"), [(FULL, Settings()), (SPLIT, Settings(taa=True))], ids=["full", "split"])
def test_errors_do_not_build_up_over_a_sequence(fields: tuple[str, ...], chosen: Settings) -> None:
    frames = traced_sequence(fields, count=8)
    den, oracle = Denoiser(frames[0].shape, settings=chosen), Oracle(frames[0].shape, chosen)
    for frame in frames:
        assert_alike(den.denoise(frame), oracle.denoise(frame))
