"""Texts of the command line become values of the right type."""

from __future__ import annotations

import re

import pytest

from svgf_cl import Eaw, Kalman, Settings, SettingsError
from svgf_cl.cli.options import parse_settings, settings_help
from svgf_cl.filters import FILTERS
from svgf_cl.settings import domains


def test_settings_are_read_by_their_own_type() -> None:
    texts = ["iterations=3", "sigma_depth=2", "taa=on", "alpha_color=0"]
    assert parse_settings("svgf", texts) == Settings(iterations=3, sigma_depth=2.0, taa=True, alpha_color=0.0)
    assert parse_settings("svgf", []) == Settings()


def test_each_filter_has_its_own() -> None:
    assert parse_settings("eaw", ["sigma_color=3"]) == Eaw(sigma_color=3.0)
    with pytest.raises(SettingsError, match=r"out of .*sigma_color .filter eaw., got 'sigma_luminance=4'"):
        parse_settings("eaw", ["sigma_luminance=4"])


def test_help_lists_every_setting_of_every_filter() -> None:
    assert all(f"{name}: " in settings_help() for kind in FILTERS.values() for name in domains(kind))


def test_help_tells_what_each_filter_has() -> None:
    shared, *own = re.split(r"\w+ also has ", settings_help())
    assert "taa: on or off [off]" in shared
    assert "iterations" not in shared, "its default differs"
    assert [re.findall(r"iterations.*?\[\d\]", text) for text in own] == [
        [f"iterations: a whole number in 1..5 [{kind().iterations}]"] for kind in (Kalman, Settings, Eaw)
    ]
    assert [("sigma_luminance" in text, "sigma_color" in text) for text in own] == [
        (True, False),
        (True, False),
        (False, True),
    ]


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
