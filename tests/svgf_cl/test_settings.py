"""Settings: every value within its range is taken, everything else is refused by name."""

from __future__ import annotations

from dataclasses import FrozenInstanceError, fields
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

from svgf_cl import Settings, SettingsError
from svgf_cl.settings import CHOICES, RANGES

WHOLE = ("iterations",)
SWITCHES = ("taa", "half_guides", "half_history")
every_number = pytest.mark.parametrize("name", RANGES)


def test_every_field_is_checked() -> None:
    assert {field.name for field in fields(Settings)} == {*RANGES, *CHOICES, *SWITCHES}


@every_number
def test_ends_of_the_range_are_taken(name: str) -> None:
    for value in RANGES[name]:
        assert getattr(Settings(**{name: value}), name) == value


@every_number
def test_beyond_the_range_is_refused(name: str) -> None:
    low, high = RANGES[name]
    beyond = (low - 1, high + 1) if name in WHOLE else (np.nextafter(low, -2e3), np.nextafter(high, 2e3))
    for value in (*beyond, -np.inf, np.inf, np.nan):
        with pytest.raises(SettingsError, match=rf"Settings\.{name}: expected .* in .*, got"):
            Settings(**{name: value})


@every_number
@pytest.mark.parametrize("value", [None, True, "1", 1j, [1]])
def test_what_is_no_number_is_refused(name: str, value: Any) -> None:
    with pytest.raises(SettingsError, match=rf"Settings\.{name}: expected a (whole )?number"):
        Settings(**{name: value})


@pytest.mark.parametrize("name", WHOLE)
def test_whole_numbers_must_be_whole(name: str) -> None:
    with pytest.raises(SettingsError, match=rf"Settings\.{name}: expected a whole number"):
        Settings(**{name: 2.0})


@pytest.mark.parametrize("value", [0, 0.5, np.float32(0.5), np.float64(0.5), Fraction(1, 2)])
def test_any_real_number_will_do(value: Any) -> None:
    assert Settings(alpha_color=value).alpha_color == value


@pytest.mark.parametrize("name", CHOICES)
def test_only_known_words_are_taken(name: str) -> None:
    for choice in CHOICES[name]:
        assert getattr(Settings(**{name: choice}), name) == choice
    for value in ("", "no such word", None, 1, True):
        with pytest.raises(SettingsError, match=rf"Settings\.{name}: expected '.*' or '.*', got"):
            Settings(**{name: value})


@pytest.mark.parametrize("name", SWITCHES)
@pytest.mark.parametrize("value", [None, 0, 1, "yes"])
def test_switches_are_bools(name: str, value: Any) -> None:
    with pytest.raises(SettingsError, match=rf"Settings\.{name}: expected True or False"):
        Settings(**{name: value})


def test_is_frozen() -> None:
    with pytest.raises(FrozenInstanceError):
        Settings().taa = True  # type: ignore[misc]


def test_no_number_compiles_anew() -> None:
    assert Settings(**{name: RANGES[name][1] for name in RANGES}).defines == Settings().defines
    chosen = Settings(taa=True, precision="fast", taps="3x3", half_guides=True, half_history=True).defines
    assert chosen == {"TAA": 1, "FAST": 1, "RADIUS": 1, "HALF_GUIDES": 1, "HALF_HISTORY": 1}
