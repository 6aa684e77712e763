"""Controls of the page: every setting as it is declared, and what the page sends back."""

from __future__ import annotations

import json
from dataclasses import fields

import pytest

from svgf_cl import Eaw, Kalman, Settings
from svgf_cl.errors import SettingsError
from svgf_cl.filters import FILTERS
from svgf_cl.view.controls import controls, filter_of, values


def test_every_setting_has_a_control_and_its_reason() -> None:
    found = json.loads(json.dumps(controls()))
    assert list(found) == list(FILTERS)
    for name, kind in FILTERS.items():
        assert [each["name"] for each in found[name]] == [each.name for each in fields(kind)]
        assert all(each["reason"] and each["kind"] in ("number", "choice", "switch") for each in found[name])


def test_a_control_offers_what_a_setting_may_be() -> None:
    found = {each["name"]: each for each in controls()["kalman"]}
    assert (found["iterations"]["least"], found["iterations"]["greatest"], found["iterations"]["whole"]) == (1, 5, True)
    assert not found["sigma_depth"]["whole"]
    assert found["taps"]["words"] == ("3x3", "5x5")
    assert found["taa"]["kind"] == "switch"
    assert found["alpha_color"]["unit"] == "share of a frame"


@pytest.mark.parametrize("settings", [Kalman(), Kalman(taa=True, iterations=2, sigma_depth=3.5), Settings(), Eaw()])
def test_what_goes_to_the_page_comes_back(settings: Kalman | Settings | Eaw) -> None:
    sent = json.loads(json.dumps(values(settings)))
    assert filter_of(settings.name, sent) == settings


def test_settings_that_are_not_sent_have_their_defaults() -> None:
    assert filter_of("svgf", {"iterations": 3}) == Settings(iterations=3)


@pytest.mark.parametrize(
    ("words", "name", "given"),
    [
        ("filter: expected kalman or svgf or .*, got 'nlm'", "nlm", {}),
        (r"filter: expected .*, got \['svgf'\]", ["svgf"], {}),
        ("filter: expected .*, got None", None, {}),
        (r"settings: expected values by name, got \[1\]", "svgf", [1]),
        (
            r"settings: expected some of alpha_color, .* \(filter eaw\), got 'change_threshold'",
            "eaw",
            {"change_threshold": 1},
        ),
        ("Kalman.iterations: expected a whole number in 1..5, got 9", "kalman", {"iterations": 9}),
        ("Kalman.iterations: expected a whole number in 1..5, got None", "kalman", {"iterations": None}),
        ("Kalman.taa: expected True or False, got 1", "kalman", {"taa": 1}),
        ("Kalman.sigma_depth: expected a number in .*, got nan", "kalman", {"sigma_depth": float("nan")}),
    ],
)
def test_wrong_settings_are_refused_by_name(words: str, name: object, given: object) -> None:
    with pytest.raises(SettingsError, match=words):
        filter_of(name, given)
