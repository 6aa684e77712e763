"""The tables that a comparison prints: one row for each filter, or, for pictures, for each frame."""

from __future__ import annotations

from svgf_cl.compare.measures import Measure
from svgf_cl.compare.page import Page, Scene

SHOWN = ("psnr", "ssim", "flip", "relmse_trimmed", "temporal", "shadows", "moving_shadows", "ghost", "lag")
BY_FRAME = ("psnr", "ssim", "flip", "relmse", "temporal")

Table = tuple[list[str], list[list[str]]]  # titles of the columns, rows


def scene_table(page: Page, scene: Scene) -> Table:
    """Return a table with a row for each filter."""
    columns = [each for each in page.measures if each.key in SHOWN]
    rows = []
    for entry in scene.entries:
        if entry.values:
            time = "" if entry.milliseconds is None else f"{entry.milliseconds:.1f}"
            rows.append([entry.rival, *(spelled(each, entry.values.get(each.key)) for each in columns), time])
    return ["filter", *(each.name for each in columns), "ms"], rows


def frame_table(page: Page, scene: Scene) -> Table:
    """Return a table of the only pictures, with a row for each frame and one for all frames together."""
    (entry,) = [each for each in scene.entries if each.values]
    columns = [each for each in page.measures if each.key in BY_FRAME]
    rows = [
        [str(number), *(spelled(each, entry.curves[each.key][index]) for each in columns)]
        for index, number in enumerate(scene.frames)
    ]
    rows.append(["all", *(spelled(each, entry.values.get(each.key)) for each in columns)])
    return ["frame", *(each.name for each in columns)], rows


def spelled(measure: Measure, value: float | None) -> str:
    """Return a value as text; empty if it was not measured."""
    return "" if value is None or value != value else measure.spell(value)
