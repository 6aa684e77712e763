"""Declares settings with default, range, unit and reason; checks and help are derived from these."""

from __future__ import annotations

import textwrap
from dataclasses import dataclass, field, fields
from numbers import Integral, Real
from typing import Any, Protocol, TypeVar

import numpy as np

from svgf_cl.errors import SettingsError, shown

DOMAIN, UNIT, REASON = "domain", "unit", "reason"  # keys of a field's metadata
SWITCHES = {"true": True, "on": True, "1": True, "false": False, "off": False, "0": False}

Value = bool | int | float | str
SettingsClass = TypeVar("SettingsClass", bound="type[SettingsBase]")


class Domain(Protocol):
    """The values that a setting may have."""

    def holds(self, value: object) -> bool:
        """Whether the setting may have this value."""

    def plain(self, value: Any) -> Value:
        """Return an allowed value as a plain Python object."""

    def parse(self, text: str) -> Value:
        """Return the value of a text, not yet checked; raise `KeyError` or `ValueError` if it has none."""

    def __str__(self) -> str: ...


@dataclass(frozen=True)
class Range:
    """Numbers from `least` to `greatest`, or the whole ones among them."""

    least: float
    greatest: float
    whole: bool

    def holds(self, value: object) -> bool:
        """Whether `value` is such a number."""
        number = isinstance(value, Integral if self.whole else Real) and not isinstance(value, bool)
        return number and self.least <= value <= self.greatest  # type: ignore[operator]

    def plain(self, value: Any) -> Value:
        """Return any number as int if it must be whole, else as float."""
        return int(value) if self.whole else float(value)

    def parse(self, text: str) -> Value:
        """Read a number."""
        return int(text) if self.whole else float(text)

    def __str__(self) -> str:
        return f"a {'whole ' if self.whole else ''}number in {self.least:g}..{self.greatest:g}"


@dataclass(frozen=True)
class Choice:
    """One of a few words."""

    words: tuple[str, ...]

    def holds(self, value: object) -> bool:
        """Whether `value` is one of the words."""
        return isinstance(value, str) and value in self.words

    def plain(self, value: Any) -> Value:
        """Return the word itself."""
        return str(value)

    def parse(self, text: str) -> Value:
        """Return the text unchanged."""
        return text

    def __str__(self) -> str:
        return " or ".join(map(repr, self.words))


@dataclass(frozen=True)
class Switch:
    """True or False."""

    def holds(self, value: object) -> bool:
        """Whether `value` is a bool."""
        return isinstance(value, bool | np.bool_)

    def plain(self, value: Any) -> Value:
        """Return Python's True or False, also for NumPy's."""
        return bool(value)

    def parse(self, text: str) -> Value:
        """Read one of the texts of `SWITCHES`."""
        return SWITCHES[text.lower()]

    def __str__(self) -> str:
        return "True or False"


def number(default: float, span: tuple[float, float], *, unit: str, reason: str) -> Any:
    """Declare a setting that is a number in `span`; it is a whole number if its default is an int."""
    return declared(default, Range(*span, whole=isinstance(default, int)), unit, reason)


def choice(default: str, *others: str, reason: str) -> Any:
    """Declare a setting that is one of several words."""
    return declared(default, Choice((default, *others)), "", reason)


def switch(default: bool, *, reason: str) -> Any:
    """Declare a setting that is on or off."""
    return declared(default, Switch(), "", reason)


def declared(default: Value, domain: Domain, unit: str, reason: str) -> Any:
    """Return the dataclass field of a setting."""
    return field(default=default, metadata={DOMAIN: domain, UNIT: unit, REASON: reason})


@dataclass(frozen=True, kw_only=True)
class SettingsBase:
    """Settings that are checked when they are made."""

    def __post_init__(self) -> None:
        for name, domain in domains(type(self)).items():
            value = getattr(self, name)
            if not domain.holds(value):
                raise SettingsError(f"{type(self).__name__}.{name}: expected {domain}, got {shown(value)}")
            object.__setattr__(self, name, domain.plain(value))


def domains(settings: type[SettingsBase]) -> dict[str, Domain]:
    """Return the domain of each setting of a class."""
    return {each.name: each.metadata[DOMAIN] for each in fields(settings)}


def defaults(settings: type[SettingsBase]) -> dict[str, Any]:
    """Return the default of each setting of a class."""
    return {each.name: each.default for each in fields(settings)}


def documented(settings: SettingsClass) -> SettingsClass:
    """Add every setting with its domain, unit, default and reason to a class's docstring, in numpydoc's format."""
    lines = []
    for each in fields(settings):
        parts = (str(each.metadata[DOMAIN]), each.metadata[UNIT], f"default {each.default!r}")
        lines.append(f"{each.name} : {', '.join(part for part in parts if part)}")
        lines.append(textwrap.indent(textwrap.fill(each.metadata[REASON], 110), "    "))
    settings.__doc__ = f"{settings.__doc__}\n\nParameters\n----------\n" + "\n".join(lines) + "\n"
    return settings
