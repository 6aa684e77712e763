"""Texts of the command line become values of the right type."""

from __future__ import annotations

import pytest

from svgf_cl import Eaw, Settings, SettingsError
from svgf_cl.cli.options import parse_settings, settings_help
from svgf_cl.filters import FILTERS
from svgf_cl.settings import domains


def test_settings_are_read_by_their_own_type() -> None:
    texts = ["iterations=3", "sigma_depth=2", "taa=on", "alpha_color=0"]
    assert parse_settings("svgf", texts) == Settings(iterations=3, sigma_depth=2.0, taa=True, alpha_color=0.0)
    assert parse_settings("svgf", []) == Settings()


def test_each_filter_has_its_own() -> None:
    assert parse_settings("eaw", ["sigma_color=3"]) == Eaw(sigma_color=3.0)
    with pytest.raises(SettingsError, match=r"out of .*sigma_color, got 'sigma_luminance=4'"):
        parse_settings("eaw", ["sigma_luminance=4"])


def test_help_lists_every_setting_of_every_filter() -> None:
    assert all(f"{name}: " in settings_help() for kind in FILTERS.values() for name in domains(kind))
