"""Settings are fitted to some sequences, judged on others, and never leave their ranges."""

from __future__ import annotations

import numpy as np
import pytest
import typer
from typer.testing import CliRunner

pytest.importorskip("embreex")

from benchmarks import fit
from svgf_cl import Eaw, Sbf, Settings, SvgfError
from svgf_cl.filters import FILTERS
from svgf_cl.settings import domains
from tests.frames import noise, wall

APP = typer.Typer()
APP.command()(fit.fit)


def clip(spread: float) -> fit.Clip:
    """A grey wall with noise, whose truth is known."""
    frames = [wall(color=0.3 + spread * (noise(seed) - 0.5)) for seed in range(6)]
    truth = fit.display(np.full((*frames[0].shape, 3), 0.3))
    return fit.Clip("wall", frames, dict.fromkeys((3, 4, 5), (truth, truth)))


def test_what_is_fitted_are_settings_of_the_filters() -> None:
    for name, settings in fit.FITTED.items():
        assert set(settings) <= set(domains(FILTERS[name]))


def test_half_the_error_and_half_the_flicker_are_two_bits() -> None:
    tolerant = Eaw(sigma_color=1e6)  # linear: half the noise in, half the error out
    linear = [fit.badness(tolerant, [clip(spread)]) for spread in (0.02, 0.01)]
    assert linear[0] - linear[1] == pytest.approx(2, abs=0.1)


def test_a_fit_finds_what_is_better_and_moves_nothing_else() -> None:
    usual = Eaw(sigma_color=0.02, sigma_depth=2.0)
    found = fit.fitted(usual, ("sigma_color",), [clip(0.2)], 12)
    assert isinstance(found, Eaw)
    assert found.sigma_color > 0.05
    assert found == Eaw(sigma_color=found.sigma_color, sigma_depth=2.0)
    assert fit.badness(found, [clip(0.2)]) < fit.badness(usual, [clip(0.2)]) - 0.5


def test_a_setting_stays_in_its_range() -> None:
    assert fit.moved(Settings(), ("sigma_normal",), np.array([30.0])) == Settings(sigma_normal=1024)
    assert fit.moved(Sbf(), ("gamma_depth", "gamma_normal"), np.array([-30.0, 0.0])) == Sbf(
        gamma_depth=0.01, gamma_normal=1.0
    )


def test_the_command_prints_what_was_gained_where() -> None:
    tiny = ("--rooms", "1", "--steps", "3", "--size", "48x32", "--spp", "32", "--held-out", "swing", "--markdown")
    said = CliRunner().invoke(APP, ["sbf", *tiny], catch_exceptions=False).output
    header, _, row = [line for line in said.splitlines() if line.startswith("|")]
    assert header == "| filter | settings | rooms | swing |"
    assert row.startswith("| sbf | gamma_depth 4 → ")


def test_a_filter_without_settings_of_its_own_is_refused() -> None:
    with pytest.raises(SvgfError, match="expected filters out of svgf, eaw, sbf, kalman, got lbf"):
        CliRunner().invoke(APP, ["lbf"], catch_exceptions=False)
