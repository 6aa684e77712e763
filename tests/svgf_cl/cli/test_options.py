"""Texts of the command line become values of the right type."""

from __future__ import annotations

import re

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
    with pytest.raises(SettingsError, match=r"among .*sigma_color .filter eaw., got 'sigma_luminance=4'"):
        parse_settings("eaw", ["sigma_luminance=4"])


def test_help_lists_every_setting_of_every_filter() -> None:
    assert all(f"{name}: " in settings_help() for kind in FILTERS.values() for name in domains(kind))


def test_help_tells_which_filters_have_a_setting() -> None:
    groups = dict(re.findall(r"Of ([^:]+): (.*?)(?=\. Of |\.$)", settings_help()))
    assert "taa: on or off [off]" in groups["all filters"]
    assert "iterations: a whole number in 1..5 [5]" in groups["svgf, eaw"]
    assert "iterations: a whole number in 1..5 [4]" in groups["kalman"]
    assert "sigma_color: " in groups["eaw"]
    assert all(text.count("sigma_color") == 0 for names, text in groups.items() if names != "eaw")


@pytest.mark.parametrize(
    ("text", "hint"),
    [
        ("sigma_detph=2", "did you mean sigma_depth=VALUE"),
        ("iterations", "filter svgf.*, got 'iter"),
        ("standard_error=on", "standard_error is a setting of kalman"),
    ],
)
def test_a_slip_of_the_hand_gets_a_hint(text: str, hint: str) -> None:
    with pytest.raises(SettingsError, match=hint):
        parse_settings("svgf", [text])
