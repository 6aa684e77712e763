"""Texts from the command line turned into values; each error says what was expected and what came."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from pathlib import Path
from typing import Annotated

import typer

from svgf_cl.errors import SettingsError, SvgfError, shown
from svgf_cl.settings import CHOICES, RANGES, Settings, describe_choice

DEFAULTS: dict[str, bool | int | float | str] = vars(Settings())
SWITCHES = {"true": True, "on": True, "1": True, "false": False, "off": False, "0": False}

# A slip of the hand beyond it: of so many pixels squared, one plane of float4 takes 16 GiB.
MAX_SIDE = 32768
MAX_FRAMES = 1_000_000  # eleven hours at 24 a second
MAX_STOPS = 64


def check_exposure(stops: float) -> float:
    """Refuse an exposure that leaves nothing but black or white."""
    if not -MAX_STOPS <= stops <= MAX_STOPS:  # NaN, too
        raise typer.BadParameter(f"expected stops in -{MAX_STOPS}..{MAX_STOPS}, got {stops:g}")
    return stops


def check_threshold(value: float | None) -> float | None:
    """Refuse NaN, which everything would miss."""
    if value is not None and math.isnan(value):
        raise typer.BadParameter("expected a number, got nan")
    return value


Output = Annotated[Path, typer.Option("-o", "--output", metavar="DIR", help="Folder to write to; made if missing.")]
Exposure = Annotated[
    float,
    typer.Option(metavar="STOPS", help="Brighten what is shown or measured as shown.", callback=check_exposure),
]
Earlier = Annotated[
    Path | None,
    typer.Option("--compare", metavar="OLD.json", help="Show how times differ from those of an earlier run."),
]
Size = Annotated[str, typer.Option(metavar="WxH", help="Width and height in pixels.")]


def parse_size(text: str) -> tuple[int, int]:
    """Read ``640x360`` as (height, width)."""
    match = re.fullmatch(r"([1-9]\d{,5})x([1-9]\d{,5})", text, re.ASCII)
    if not match:
        raise SvgfError(f"--size: expected WIDTHxHEIGHT in pixels such as 640x360, got {shown(text)}")
    width, height = int(match[1]), int(match[2])
    if max(width, height) > MAX_SIDE:
        raise SvgfError(f"--size: expected at most {MAX_SIDE} pixels a side, got {text}")
    return height, width


def parse_settings(texts: Iterable[str]) -> Settings:
    """Read ``["iterations=4", "taa=on"]`` as `Settings`; `SettingsError` for an unknown name or a wrong value."""
    values: dict[str, bool | int | float | str] = {}
    for text in texts:
        name, _, value = text.partition("=")
        if name not in DEFAULTS:
            raise SettingsError(f"--set: expected NAME=VALUE with a name out of {', '.join(DEFAULTS)}, got {text!r}")
        try:
            values[name] = parse_value(name, value)
        except (KeyError, ValueError) as error:
            raise SettingsError(f"--set {name}: expected {describe(name)}, got {value!r}") from error
    return Settings(**values)  # type: ignore[arg-type]  # each value was made by its own field's type


def parse_value(name: str, text: str) -> bool | int | float | str:
    """Read the value of setting `name`; KeyError or ValueError where it is none. `Settings` checks its range."""
    if name in CHOICES:
        return text
    return type(DEFAULTS[name])(text) if name in RANGES else SWITCHES[text.lower()]


def describe(name: str) -> str:
    """Describe the values that setting `name` may have: ``"a whole number in 1..5"``."""
    if name in CHOICES:
        return describe_choice(name)
    if name not in RANGES:
        return "on or off"
    low, high = RANGES[name]
    return f"a {'whole ' if isinstance(DEFAULTS[name], int) else ''}number in {low:g}..{high:g}"


def settings_help() -> str:
    """Describe every setting with its range and default, for the help text."""
    parts = (f"{name}: {describe(name)} [{default}]" for name, default in DEFAULTS.items())
    return "Change a setting of the filter; may be repeated. " + "; ".join(parts) + "."


SettingTexts = Annotated[list[str], typer.Option("--set", metavar="NAME=VALUE", help=settings_help())]
