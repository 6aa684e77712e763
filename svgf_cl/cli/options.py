"""Options that several commands share, and functions that turn their texts into values."""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Annotated

import typer

from svgf_cl.compare.metrics import SSIM_WINDOW
from svgf_cl.errors import SettingsError, SvgfError, shown
from svgf_cl.filters import FILTERS
from svgf_cl.filters.filter import Filter
from svgf_cl.io.atomic import output_file
from svgf_cl.io.display import MAX_STOPS
from svgf_cl.settings import Domain, Switch, Value, defaults, domains

# A larger size is a typing error: with this many pixels a side, one plane of float4 takes 16 GiB.
MAX_SIDE = 32768
MAX_FRAMES = 1_000_000  # eleven hours at 24 a second

STDOUT = Path("-")  # a value of --json


def check_exposure(stops: float) -> float:
    """Return the exposure; raise an error if pictures would be all black or white."""
    if not -MAX_STOPS <= stops <= MAX_STOPS:  # NaN, too
        raise typer.BadParameter(f"expected stops in -{MAX_STOPS}..{MAX_STOPS}, got {stops:g}")
    return stops


Frames = Annotated[
    list[Path],
    typer.Argument(
        metavar="FRAMES", help="The EXR files of one shot, in any order, or their folder; they are sorted by number."
    ),
]
AllowGaps = Annotated[
    bool, typer.Option("--allow-gaps", help="Accept a shot that lacks frames; start again after each gap, as at a cut.")
]
Output = Annotated[Path, typer.Option("-o", "--output", metavar="DIR", help="Folder to write to; made if missing.")]
Exposure = Annotated[
    float,
    typer.Option(
        metavar="STOPS",
        help="Brighten what is shown (PNG files, pages) and display-referred measures; EXR files do not change.",
        callback=check_exposure,
    ),
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


def parse_measured_size(text: str) -> tuple[int, int]:
    """Read the size of pictures to measure as `parse_size` does; raise `SvgfError` if it is too small for SSIM."""
    shape = parse_size(text)
    if min(shape) < SSIM_WINDOW:
        raise SvgfError(f"--size: expected at least {SSIM_WINDOW}x{SSIM_WINDOW} pixels, which SSIM needs, got {text}")
    return shape


def check_files(*files: Path | None) -> None:
    """Raise `FileError` if one of these output files cannot be written; `STDOUT` always can."""
    for file in files:
        if file and file != STDOUT:
            output_file(file)


def parse_settings(filter_: str, texts: Iterable[str], option: str = "--set") -> Filter:
    """Read ``"svgf", ["iterations=4", "taa=on"]`` as a `Filter`.

    Raises
    ------
    SettingsError
        For a wrong name or value; the message names `option`.
    """
    if filter_ not in FILTERS:
        raise SettingsError(f"--filter: expected {' or '.join(FILTERS)}, got {shown(filter_)}")
    kind = FILTERS[filter_]
    known = domains(kind)
    values: dict[str, Value] = {}
    for text in texts:
        name, _, value = text.partition("=")
        if name not in known or not value:
            raise SettingsError(
                f"{option}: expected NAME=VALUE with a name among {', '.join(known)} (filter {filter_}), got {text!r}"
                + hint(name, known)
            )
        try:
            values[name] = known[name].parse(value)
        except (KeyError, ValueError) as error:
            raise SettingsError(f"{option} {name}: expected {describe(known[name])}, got {value!r}") from error
    return kind(**values)


def hint(name: str, known: Iterable[str]) -> str:
    """Return a hint on a name that is no setting of the filter; empty if there is none."""
    near = difflib.get_close_matches(name, known, 1, 0.75)
    if near:
        return f"; did you mean {near[0]}=VALUE?"
    having = [other for other, kind in FILTERS.items() if name in domains(kind)]
    return f"; {name} is a setting of {' and '.join(having)}" if having else ""


def describe(domain: Domain) -> str:
    """Return the possible values of a setting, as on the command line."""
    return "on or off" if isinstance(domain, Switch) else str(domain)


def settings_help() -> str:
    """Return the help text on all settings with ranges and defaults, grouped by the filters that have them."""
    owners: dict[str, list[str]] = {}
    for filter_, kind in FILTERS.items():
        for name in domains(kind):
            owners.setdefault(described(kind, name), []).append(filter_)
    groups: dict[tuple[str, ...], list[str]] = {}
    for text, filters in sorted(owners.items(), key=lambda item: -len(item[1])):
        groups.setdefault(tuple(filters), []).append(text)
    parts = [f"Of {spelled(filters)}: {'; '.join(texts)}" for filters, texts in groups.items()]
    return f"Change a setting of the filter; may be repeated. docs/settings.md says what each does. {'. '.join(parts)}."


def spelled(filters: Sequence[str]) -> str:
    """Return the names of filters as text, or "all filters"."""
    return "all filters" if len(filters) == len(FILTERS) else ", ".join(filters)


def described(kind: type[Filter], name: str) -> str:
    """Return a setting with its possible values and its default, as on the command line."""
    default = defaults(kind)[name]
    text = {True: "on", False: "off"}[default] if isinstance(default, bool) else default
    return f"{name}: {describe(domains(kind)[name])} [{text}]"


FilterName = Annotated[str, typer.Option("--filter", metavar="NAME", help=f"The filter: {' or '.join(FILTERS)}.")]
SettingTexts = Annotated[list[str], typer.Option("--set", metavar="NAME=VALUE", help=settings_help())]
