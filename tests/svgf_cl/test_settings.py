"""Settings: every value that a setting may have is taken, everything else is refused by name."""

from __future__ import annotations

from dataclasses import FrozenInstanceError, fields
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

from svgf_cl import Eaw, Kalman, Settings, SettingsError
from svgf_cl.filters import FILTERS
from svgf_cl.settings import REASON, Choice, Range, Switch, defaults, domains

DOMAINS = domains(Settings)
RANGES = {name: domain for name, domain in DOMAINS.items() if isinstance(domain, Range)}
CHOICES = {name: domain.words for name, domain in DOMAINS.items() if isinstance(domain, Choice)}
SWITCHES = [name for name, domain in DOMAINS.items() if isinstance(domain, Switch)]
WHOLE = [name for name, domain in RANGES.items() if domain.whole]
every_number = pytest.mark.parametrize("name", RANGES)
every_filter = pytest.mark.parametrize("kind", FILTERS.values())


@every_filter
def test_every_setting_has_a_reason_and_a_default_that_it_may_have(kind: type[Settings] | type[Eaw]) -> None:
    for field in fields(kind):
        assert domains(kind)[field.name].holds(field.default)
        assert field.metadata[REASON]


@every_filter
def test_the_docstring_tells_every_setting(kind: type[Settings] | type[Eaw]) -> None:
    assert kind.__doc__ is not None
    for name, default in defaults(kind).items():
        assert f"\n{name} : " in kind.__doc__
        assert f"default {default!r}" in kind.__doc__


@every_number
def test_ends_of_the_range_are_taken(name: str) -> None:
    for value in (RANGES[name].least, RANGES[name].greatest):
        assert getattr(Settings(taa=True, **{name: value}), name) == value


@every_number
def test_beyond_the_range_is_refused(name: str) -> None:
    low, high = RANGES[name].least, RANGES[name].greatest
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
    chosen = Settings(alpha_color=value).alpha_color
    assert chosen == value
    assert type(chosen) is float


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


@every_filter
def test_pixel_filter_needs_taa(kind: type[Settings] | type[Eaw] | type[Kalman]) -> None:
    with pytest.raises(SettingsError, match=rf"{kind.__name__}\.pixel_filter: expected 0 without taa, got 0\.15; set"):
        kind(pixel_filter=0.15)


def test_errors_name_the_filter() -> None:
    with pytest.raises(SettingsError, match=r"Eaw\.sigma_color: expected a number in"):
        Eaw(sigma_color=-1)


def test_is_frozen() -> None:
    with pytest.raises(FrozenInstanceError):
        Settings().taa = True  # type: ignore[misc]
