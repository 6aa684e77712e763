"""Writes the results of a comparison: JSON, CSV, and the parts from which an interrupted run is resumed."""

from __future__ import annotations

import base64
import csv
import functools
import hashlib
import io
import json
import math
from collections.abc import Sequence
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any

import svgf_cl
from svgf_cl.compare.measures import MEASURES, Measure
from svgf_cl.compare.metrics import why_no_flip
from svgf_cl.compare.page import Entry, Page, Scene
from svgf_cl.device.tuning import kernels_digest
from svgf_cl.io.atomic import read_json, write_text

IMAGES = ("picture", "heat", "clip", "profile")  # the images of an `Entry`
NEVER = "inf"  # JSON has no number for it; a value that was not measured is null


def results(page: Page) -> str:
    """Return all values as JSON."""
    scenes = [
        {
            "name": scene.name,
            "note": scene.note,
            "size": list(reversed(scene.size)),
            "frames": list(scene.frames),
            "filters": {each.rival: figures(each) for each in scene.entries if each.values},
        }
        for scene in page.scenes
    ]
    measures = {each.key: {"title": each.title, "unit": each.unit, "meaning": each.meaning} for each in page.measures}
    record = {"about": dict(page.about), "measures": measures, "scenes": scenes}
    return json.dumps(record, indent=1, allow_nan=False) + "\n"


def figures(entry: Entry) -> dict[str, Any]:
    """Return the measured values of a rival."""
    return {
        "milliseconds": entry.milliseconds,
        "values": {key: plain(value) for key, value in entry.values.items()},
        "curves": {key: [plain(value) for value in values] for key, values in entry.curves.items()},
    }


def plain(value: float | None) -> float | str | None:
    """Return a number in a form that JSON has."""
    if value is None or math.isnan(value):
        return None
    return value if math.isfinite(value) else NEVER if value > 0 else f"-{NEVER}"


def table(page: Page) -> str:
    """Return all values as CSV: one row for each scene and filter."""
    file = io.StringIO()
    writer = csv.writer(file, lineterminator="\n")
    keys = [each.key for each in page.measures]
    writer.writerow(["scene", "filter", *keys, "milliseconds"])
    for scene in page.scenes:
        for entry in scene.entries:
            if entry.values:
                found = [plain(entry.values.get(key)) for key in keys]
                writer.writerow([scene.name, entry.rival, *found, entry.milliseconds])
    return file.getvalue()


def part_name(footage_identity: str, rivals: Sequence[str], exposure: float, device: str) -> str:
    """Return a file name for a scene's results; it changes with all inputs and with svgf_cl's own code.

    Parameters
    ----------
    footage_identity : str
    rivals : sequence of str
        In order: the first decides which piece clips show.
    exposure : float, stops
    device : str
        The device on which times were measured.
    """
    inputs = json.dumps([footage_identity, list(rivals), exposure, device, why_no_flip(), code_digest()])
    return hashlib.sha256(inputs.encode()).hexdigest()[:24]


@functools.cache
def code_digest() -> str:
    """Return a digest of svgf_cl: its kernels, its code, and the weights of its networks."""
    code = hashlib.sha256(kernels_digest().encode())
    files = Path(svgf_cl.__file__).parent.rglob("*")
    for source in sorted(path for path in files if path.suffix in (".py", ".json")):
        code.update(source.read_bytes())
    return code.hexdigest()


def write_part(path: Path, scene: Scene) -> None:
    """Write the results of a finished scene to a file."""
    record = asdict(scene)
    for entry in record["entries"]:
        entry |= {name: base64.b64encode(entry[name]).decode("ascii") for name in IMAGES if entry[name] is not None}
        entry["values"] = {key: plain(value) for key, value in entry["values"].items()}
        entry["curves"] = {key: [plain(value) for value in values] for key, values in entry["curves"].items()}
    write_text(path, json.dumps(record))


def read_part(path: Path) -> Scene | None:
    """Return the scene that an earlier run wrote to a file; None if there is no such file, or it cannot be read."""
    try:
        record = read_json(path)
        entries = [read_entry(each) for each in record.pop("entries")]
        names = {each.name for each in fields(Scene)}
        crop = tuple(record["crop"]) if record["crop"] else None
        return Scene(
            **{k: v for k, v in record.items() if k in names}
            | {"crop": crop, "size": tuple(record["size"]), "entries": entries}
        )
    except (OSError, AttributeError, KeyError, TypeError, ValueError):
        return None


def read_entry(record: dict[str, Any]) -> Entry:
    """Return one rival's entry from the record of a scene."""
    images = {name: base64.b64decode(record[name], validate=True) for name in IMAGES if record[name] is not None}
    values = {key: number(value) for key, value in record["values"].items()}
    curves = {key: [number(value) for value in each] for key, each in record["curves"].items()}
    return Entry(**record | images | {"values": values, "curves": curves})


def number(value: float | str | None) -> float:
    """Return the number that `plain` wrote."""
    return math.nan if value is None else float(value)


def measured(scenes: Sequence[Scene]) -> list[Measure]:
    """Return the measures that have a value for at least one rival in one scene."""

    def has(key: str) -> bool:
        entries = (entry for scene in scenes for entry in scene.entries)
        return any(not math.isnan(number(entry.values.get(key))) for entry in entries)

    return [each for each in MEASURES if has(each.key)]
