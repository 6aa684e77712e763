"""Filters and their settings as controls of the page, and the conversion of the page's answers to a filter."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, fields
from typing import Any

from svgf_cl.errors import SettingsError, shown
from svgf_cl.filters import FILTERS
from svgf_cl.filters.filter import Filter
from svgf_cl.settings import DOMAIN, REASON, UNIT, Choice, Domain, Range, domains


def controls() -> dict[str, list[dict[str, Any]]]:
    """The controls of each filter's settings, by the filter's name, as JSON."""
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
    """The kind of control for a setting, and its choices or range."""
    if isinstance(domain, Range):
        return {"kind": "number", "least": domain.least, "greatest": domain.greatest, "whole": domain.whole}
    if isinstance(domain, Choice):
        return {"kind": "choice", "words": domain.words}
    return {"kind": "switch"}


def values(settings: Filter) -> dict[str, Any]:
    """The values of a filter's settings, by name."""
    return asdict(settings)


def filter_of(name: object, given: object) -> Filter:
    """The filter of this name with these settings; all other settings have their defaults.

    Raises
    ------
    SettingsError
        If there is no such filter or no such setting, or if a value is out of range.
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
