"""The folder of a plan: `plan.json`, its schema, kernels and constant arrays."""

from __future__ import annotations

import json
from importlib import resources
from pathlib import Path

from svgf_cl.export.document import SCHEMA, data_files, document
from svgf_cl.filters.filter import Filter
from svgf_cl.io.atomic import folder_written_whole
from svgf_cl.schedule import Schedule

PLAN = "plan.json"


def write_plan(folder: Path, schedule: Schedule, settings: Filter) -> None:
    """Write a schedule of whole frames to a new folder, completely or not at all.

    Parameters
    ----------
    folder : Path
    schedule : Schedule
    settings : Filter
        The filter to which the pipeline belongs.

    Raises
    ------
    FileError
        If the path exists already, or the folder cannot be written.
    SvgfError
        If the package pcpp is missing.
    """
    schema = (resources.files("svgf_cl.export") / SCHEMA).read_bytes()
    text = json.dumps(document(schedule, settings), indent=1, allow_nan=False) + "\n"
    files = {PLAN: text.encode(), SCHEMA: schema, **data_files(schedule)}
    with folder_written_whole(folder) as aside:
        for name, content in files.items():
            (aside / name).parent.mkdir(exist_ok=True)
            (aside / name).write_bytes(content)
