"""Writes the page of ``svgf-cl compare``: rival filters side by side, in one HTML file that needs no other file."""

from __future__ import annotations

import base64
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from statistics import fmean
from typing import Any

from jinja2 import Environment
from markupsafe import Markup

from svgf_cl.compare.measures import Measure
from svgf_cl.io.atomic import write_text


@dataclass(frozen=True)
class Entry:
    """The pictures and values of one rival in one scene.

    Parameters
    ----------
    rival : str
    values : mapping of str to float or None
        By the measures' keys. None and NaN mean "not measured".
    curves : mapping of str to sequence of float or None
        The same for each of the scene's frames.
    milliseconds : float or None
        Time of a frame.
    picture : bytes
        The frame that is shown, as a WebP or PNG file; all images here are such files.
    heat : bytes or None
        Map of its error.
    clip : bytes or None
        Animation of the scene's crop.
    profile : bytes or None
        The scene's row of pixels over time, time downwards.
    """

    rival: str
    values: Mapping[str, float | None]
    curves: Mapping[str, Sequence[float | None]]
    milliseconds: float | None
    picture: bytes
    heat: bytes | None
    clip: bytes | None
    profile: bytes | None


@dataclass(frozen=True)
class Scene:
    """The results of all rivals in one scene.

    Parameters
    ----------
    name : str
    note : str
        What to look at; may be empty.
    frames : sequence of int
        Numbers of the frames that were judged.
    shown : int
        Number of the frame in the pictures.
    size : tuple of int
        Height and width of the pictures.
    crop : tuple of int or None
        Left edge, top edge, width and height of the clips.
    row : int or None
        The row of pixels in the profiles.
    entries : sequence of Entry
        The reference and the noisy input are among them.
    reference : str
        Name of the reference's entry. It is never marked as the best.
    noisy : str or None
        Name of the noisy input's entry. It is never marked as the best.
    """

    name: str
    note: str
    frames: Sequence[int]
    shown: int
    size: tuple[int, int]
    crop: tuple[int, int, int, int] | None
    row: int | None
    entries: Sequence[Entry]
    reference: str
    noisy: str | None = None


@dataclass(frozen=True)
class Page:
    """The content of the page.

    Parameters
    ----------
    title : str
    about : mapping of str to str
        How the results were made: device, versions, command.
    measures : sequence of Measure
        From left to right. The first is also shown below the pictures.
    scenes : sequence of Scene
    """

    title: str
    about: Mapping[str, str]
    measures: Sequence[Measure]
    scenes: Sequence[Scene]


@dataclass(frozen=True)
class Cell:
    """A value in a table, whether it is the best of its column, and a note on it."""

    text: str
    best: bool = False
    note: str = ""


@dataclass(frozen=True)
class Table:
    """A table of values: a column for each measure, a row for each rival."""

    measures: Sequence[Measure]
    rows: Mapping[str, Sequence[Cell]]


UNKNOWN = "-"
TIME = Measure("milliseconds", "Time", "ms", ".2f", -1, None, "How long a frame takes on the device.")

Tally = Mapping[str, Mapping[str, Sequence[float]]]  # by rival and key: the values of the scenes that have one


def write(page: Page, path: Path) -> None:
    """Write the page to a file."""
    write_text(path, render(page))


def render(page: Page) -> str:
    """Return the page's HTML."""
    environment = Environment(autoescape=True, trim_blocks=True, lstrip_blocks=True)
    environment.filters["uri"] = data_uri
    environment.filters["gist"] = lambda entry: gist(entry, page.measures[:1])
    return environment.from_string(_file("page.html")).render(
        page=page,
        rivals=rivals(page),
        style=Markup(_file("controls.css") + _file("page.css")),
        script=Markup(_file("gestures.js") + _file("page.js")),
        data=data(page),
        summary=table(page.scenes, page.measures),
        tables=[table([scene], page.measures) for scene in page.scenes],
        curves=[curves(scene, page.measures) for scene in page.scenes],
        has_heat=any(entry.heat for scene in page.scenes for entry in scene.entries),
    )


def rivals(page: Page) -> list[str]:
    """Return all rivals' names, in the order of their first entry."""
    return list(dict.fromkeys(entry.rival for scene in page.scenes for entry in scene.entries))


def table(scenes: Sequence[Scene], measures: Sequence[Measure]) -> Table:
    """Return the table of means over scenes; rivals and measures without a value are left out."""
    found = tally(scenes)
    columns = [measure for measure in (*measures, TIME) if any(measure.key in values for values in found.values())]
    outside = {name for scene in scenes for name in (scene.reference, scene.noisy)}
    cells = [column_cells(found, measure, outside) for measure in columns]
    return Table(columns, {rival: [column.get(rival, Cell(UNKNOWN)) for column in cells] for rival in found})


def tally(scenes: Sequence[Scene]) -> Tally:
    """Return all measured values, by rival and key."""
    found: dict[str, dict[str, list[float]]] = {}
    for scene in scenes:
        for entry in scene.entries:
            for key, value in {**entry.values, TIME.key: entry.milliseconds}.items():
                if value is not None and not math.isnan(value):
                    found.setdefault(entry.rival, {}).setdefault(key, []).append(value)
    return found


def column_cells(found: Tally, measure: Measure, outside: set[str | None]) -> dict[str, Cell]:
    """Return the cells of a column, by rival.

    If a rival was measured in fewer scenes than others, its cell says so and is never the best, as it may have missed
    the hard scenes.
    """
    values = {rival: found[rival][measure.key] for rival in found if measure.key in found[rival]}
    scenes = max(map(len, values.values()))
    means = {rival: fmean(each) for rival, each in values.items()}
    whole = {rival: means[rival] for rival in means if len(values[rival]) == scenes and rival not in outside}
    top = best(whole, measure)
    notes = {rival: "" if len(each) == scenes else f"{len(each)} of {scenes} scenes" for rival, each in values.items()}
    return {rival: Cell(measure.spell(mean), rival in top, notes[rival]) for rival, mean in means.items()}


def best(values: Mapping[str, float], measure: Measure) -> set[str]:
    """Return the best rivals: several if their texts are the same, none if there are fewer than two rivals."""
    if len(values) < 2 or not measure.aim:
        return set()
    top = max(values.values(), key=measure.merit)
    return {
        rival
        for rival, value in values.items()
        if measure.merit(value) == measure.merit(top) or measure.spell(value) == measure.spell(top)
    }


def gist(entry: Entry, measures: Sequence[Measure]) -> list[str]:
    """Return the texts below an entry's picture: some measures, and its time."""
    said = [(measure, entry.values.get(measure.key)) for measure in measures]
    known = [(measure, value) for measure, value in said if value is not None and not math.isnan(value)]
    texts = [f"{measure.title} {measure.spell(value)} {measure.unit}".rstrip() for measure, value in known]
    return texts if entry.milliseconds is None else [*texts, f"{TIME.spell(entry.milliseconds)} ms"]


def curves(scene: Scene, measures: Sequence[Measure]) -> list[Measure]:
    """Return the measures that have curves in a scene; a single frame has none."""
    if len(scene.frames) < 2:
        return []
    return [
        measure
        for measure in measures
        if any(point is not None for entry in scene.entries for point in points(entry.curves.get(measure.key, ())))
    ]


def points(curve: Sequence[float | None]) -> list[float | None]:
    """Return a curve with None for values that can neither be drawn nor written as JSON."""
    return [value if value is not None and math.isfinite(value) else None for value in curve]


def data(page: Page) -> dict[str, Any]:
    """Return the data for the page's script; the pictures are in the page itself."""
    names = rivals(page)
    return {
        "rivals": names,
        "measures": {measure.key: {"name": measure.name, "aim": measure.aim} for measure in page.measures},
        "speed": {measure.key: found for measure in page.measures if (found := list(speed(page, measure.key)))},
        "scenes": [
            {
                "size": scene.size,
                "frames": list(scene.frames),
                "curves": {
                    measure.key: {
                        names.index(entry.rival): points(entry.curves.get(measure.key, ())) for entry in scene.entries
                    }
                    for measure in curves(scene, page.measures)
                },
            }
            for scene in page.scenes
        ],
    }


def speed(page: Page, key: str) -> Iterator[tuple[str, float, float]]:
    """Yield the name, the mean time and the mean value of each rival that has both."""
    for rival, values in tally(page.scenes).items():
        if key in values and TIME.key in values:
            time, value = fmean(values[TIME.key]), fmean(values[key])
            if time > 0 and math.isfinite(time) and math.isfinite(value):
                yield rival, time, value


def data_uri(image: bytes) -> Markup:
    """Return an image as a data URI."""
    kind = "png" if image.startswith(b"\x89PNG") else "webp"
    return Markup("data:image/{};base64,{}").format(kind, base64.b64encode(image).decode("ascii"))


def _file(name: str) -> str:
    return (resources.files("svgf_cl.compare") / name).read_text(encoding="utf-8")
