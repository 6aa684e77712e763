"""Writes docs/settings.md, what each setting of each filter does, from the filters' declarations."""

from __future__ import annotations

from dataclasses import fields
from pathlib import Path

from svgf_cl.filters import DEFAULT, FILTERS
from svgf_cl.filters.filter import Filter
from svgf_cl.io.atomic import write_text
from svgf_cl.settings import DOMAIN, REASON, UNIT

TARGET = Path("docs/settings.md")

INTRODUCTION = f"""# Settings

Made by `make docs` (`python scripts/settings_page.py`) from `svgf_cl/filters`; do not edit.

Every filter is a class of settings, such as `Kalman(iterations=3)`, for `Denoiser(..., settings=...)`.
On the command line: `svgf-cl denoise --filter kalman --set iterations=3`, with `on` for `True` and `off` for `False`.
`{DEFAULT.__name__}` is the default.
Three of its settings change the picture most:

- `sigma_luminance`: a larger value leaves less noise, a smaller one less blur;
- `change_threshold`: with a larger value fireflies flicker less, with a smaller one moving shadows lag less;
- `taa`: steady, smooth edges.

Each setting is listed with its default, its range, its unit and its meaning.
[algorithm.md](algorithm.md) has the equations.
`svgf-cl view` shows the effect of a setting while frames play ([view.md](view.md)).
"""


def page() -> str:
    """The whole page."""
    return INTRODUCTION + "".join(settings_of(each) for each in FILTERS.values())


def settings_of(kind: type[Filter]) -> str:
    """The settings of one filter: default, values and unit of each, its meaning, and the reason for the default."""
    summary = (kind.__doc__ or "").partition("\n")[0].removesuffix(" Equations: docs/algorithm.md.")
    items = []
    for each in fields(kind):
        values = ", ".join(part for part in (str(each.metadata[DOMAIN]), each.metadata[UNIT]) if part)
        items.append(f"- **`{each.name}`** `= {each.default!r}`, {values}.\\\n  {each.metadata[REASON]}\n")
    return f"\n## {kind.__name__}\n{summary} `--filter {kind.name}`\n\n{''.join(items)}"


def main() -> None:
    """Write the page."""
    write_text(TARGET, page())
    print(TARGET)


if __name__ == "__main__":
    main()
