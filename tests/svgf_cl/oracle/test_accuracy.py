"""The measure of accuracy sees what it should: a wrong kernel by name, and nothing where all is right."""

from __future__ import annotations

from types import ModuleType

import numpy as np
import pytest

from svgf_cl import Denoiser, Eaw, Settings
from svgf_cl.filters.filter import Filter
from svgf_cl.filters.signals import Inputs
from svgf_cl.oracle import svgf, temporal
from svgf_cl.oracle.accuracy import Deviation, deviations, worst
from tests.frames import SPLIT, TINY, bumpy_sequence


@pytest.mark.parametrize("chosen", [Settings(), Settings(taa=True), Eaw()], ids=["svgf", "svgf, taa", "eaw"])
def test_covers_every_stage_and_the_result(chosen: Filter) -> None:
    frames = bumpy_sequence(SPLIT, count=2, shape=TINY)
    den = Denoiser(TINY, settings=chosen)
    den.denoise(frames[0])
    found = deviations(frames, chosen)
    assert set(found) == {*den.stages, "out"}
    assert {deviation.kernel for deviation in found.values()} == {
        entry.kernel for entry in den.settings.pipeline(Inputs.of(frames[0])).passes
    }


@pytest.mark.parametrize(("module", "kernel"), [(temporal, "temporal"), (svgf, "atrous")])
def test_a_wrong_kernel_shows_in_its_own_stages_alone(
    module: ModuleType, kernel: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    right = getattr(module, kernel)
    stages = {"temporal": {"accumulated", "mean", "moment_variance"}, "atrous": {"level_1", "level_1_variance"}}

    def wrong(color, *rest):
        return right(1.01 * color, *rest)

    monkeypatch.setattr(module, kernel, wrong)
    found = deviations(bumpy_sequence(SPLIT, shape=TINY), Settings(iterations=1))
    assert {name for name, deviation in found.items() if deviation.decided_otherwise > 0.1} <= stages[kernel]
    assert any(deviation.decided_otherwise > 0.5 for deviation in found.values())


def test_what_was_decided_otherwise_is_set_aside() -> None:
    found = Deviation.of(
        "taa", error=np.array([0.0, 1e-6, 3e-6, 1.0, np.nan]), size=np.array([2.0, 0.1, 1.0, 1.0, 1.0])
    )
    assert found == Deviation("taa", absolute=3e-6, relative=1e-6 / 0.1, ulps=1e-6 * 2**27, decided_otherwise=0.4)


def test_an_error_in_the_last_place_is_one_ulp() -> None:
    size = np.array([1e-20, 1.0, 1.5, 3e38])
    assert Deviation.of("taa", np.spacing(size.astype(np.float32)).astype(np.float64), size).ulps == 1


def test_the_worst_of_all_frames_counts() -> None:
    frames = [Deviation("taa", 1, 4, 5, 0.0), Deviation("taa", 2, 3, 6, 0.5)]
    assert worst(frames) == Deviation("taa", 2, 4, 6, 0.25)
