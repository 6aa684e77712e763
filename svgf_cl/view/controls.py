"""Filters and their settings as the page's controls have them, and what the page says of them turned into a filter."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, fields
from typing import Any

from svgf_cl.errors import SettingsError, shown
from svgf_cl.filters import FILTERS
from svgf_cl.filters.filter import Filter
from svgf_cl.settings import DOMAIN, REASON, UNIT, Choice, Domain, Range, domains


def controls() -> dict[str, list[dict[str, Any]]]:
    """The controls of each filter's settings, by the filter's name, as JSON has them."""
    return {
        name: [
            {
                "name": each.name,
                "default": each.default,
                "unit": each.metadata[UNIT],
                "reason": each.metadata[REASON],
                **control(each.metadata[DOMAIN]),
            }
            for each in fields(kind)
        ]
        for name, kind in FILTERS.items()
    }


def control(domain: Domain) -> dict[str, Any]:
    """The kind of control that a setting takes, and what it offers."""
    if isinstance(domain, Range):
        return {"kind": "number", "least": domain.least, "greatest": domain.greatest, "whole": domain.whole}
    if isinstance(domain, Choice):
        return {"kind": "choice", "words": domain.words}
    return {"kind": "switch"}


def values(settings: Filter) -> dict[str, Any]:
    """The settings of a filter by their names."""
    return asdict(settings)


def filter_of(name: object, given: object) -> Filter:
    """The filter of that name with these settings; others have their defaults.

    Raises
    ------
    SettingsError
        There is no such filter, no such setting, or a setting is out of its range.
    """
    if not isinstance(name, str) or name not in FILTERS:
        raise SettingsError(f"filter: expected {' or '.join(FILTERS)}, got {shown(name)}")
    known = domains(FILTERS[name])
    if not isinstance(given, Mapping):
        raise SettingsError(f"settings: expected values by name, got {shown(given)}")
    for each in given:
        if each not in known:
            raise SettingsError(f"settings: expected some of {', '.join(known)} (filter {name}), got {shown(each)}")
    return FILTERS[name](**given)
