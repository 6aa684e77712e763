"""`plan.json`: a schedule as a document, and the files that it refers to. The format: docs/export.md."""

from __future__ import annotations

from dataclasses import asdict
from importlib.metadata import version
from typing import Any

import numpy as np

from svgf_cl.device import programs
from svgf_cl.device.layout import HALO
from svgf_cl.device.memory import Fill, Memory
from svgf_cl.export.preprocess import preprocessed
from svgf_cl.filters.filter import Filter
from svgf_cl.filters.pipeline import OUT, Buffer, Pipeline, Quantity
from svgf_cl.fingerprint import library_version
from svgf_cl.schedule import IN_PLACE, Schedule, ScheduledPass, whole_groups

FORMAT = 1  # of the document; increases with every change that a host has to know about
SCHEMA = "plan.schema.json"

Entry = dict[str, Any]  # an object of JSON

PYTHONS_OWN = ("pinned_copies",)  # fields of a tuning that concern numpy arrays only


def document(schedule: Schedule, settings: Filter) -> Entry:
    """The document for a schedule of whole frames.

    Parameters
    ----------
    schedule : Schedule
    settings : Filter
        The filter to which the pipeline belongs.
    """
    return {
        "$schema": SCHEMA,
        "format": FORMAT,
        "made_by": {"svgf_cl": version("svgf_cl"), "code": library_version()},
        "filter": {"name": settings.name, "settings": asdict(settings)},
        "tuning": {name: value for name, value in asdict(schedule.tuning).items() if name not in PYTHONS_OWN},
        "image": {"width": schedule.layout.width, "height": schedule.layout.height, "halo": HALO},
        "build_options": list(programs.OPTIONS),
        "programs": [program_file(source) for source in sources(schedule.pipeline)],
        "arrays": [
            {"name": name, "is_output": name == OUT, **of_array(array.dtype, array.shape)}
            for name, array in schedule.arrays.items()
        ],
        "constants": [
            {"file": name, **of_array(values.dtype, values.shape)}
            for name, values in constant_arrays(schedule.pipeline).items()
        ],
        "memory": [{"bytes": size} for size in schedule.memory.sizes],
        "buffers": [of_buffer(buffer, schedule) for buffer in schedule.memory.slot_of],
        "cut": [of_fill(fill, schedule.memory) for fill in schedule.memory.fills(schedule.pipeline.lasting)],
        "launches": [of_launch(scheduled, schedule) for scheduled in schedule.passes],
    }


def data_files(schedule: Schedule) -> dict[str, bytes]:
    """The files that the document refers to, by name: kernels and constant arrays."""
    pipeline = schedule.pipeline
    kernels = {program_file(source): kernel_text(source, schedule).encode() for source in sources(pipeline)}
    arrays = constant_arrays(pipeline).items()
    return kernels | {name: values.astype(values.dtype.newbyteorder("<")).tobytes() for name, values in arrays}


def sources(pipeline: Pipeline) -> list[str]:
    """The source files of a pipeline, each once."""
    return list(dict.fromkeys(entry.source for entry in pipeline.passes))


def program_file(source: str) -> str:
    """The path of a source file in the folder."""
    return f"kernels/{source}.cl"


def kernel_text(source: str, schedule: Schedule) -> str:
    """The text of a source file, with all macros expanded."""
    text = preprocessed(programs.source(source), programs.macros(source, schedule.defines))
    return f"// {source}.cl of svgf_cl {version('svgf_cl')}, preprocessed. SPDX-License-Identifier: Apache-2.0\n{text}"


def constant_arrays(pipeline: Pipeline) -> dict[str, np.ndarray]:
    """The constant arrays of all passes, by the names of their files."""
    return {
        constant_file(entry.label, name): values for entry in pipeline.passes for name, values in entry.arrays.items()
    }


def constant_file(label: str, name: str) -> str:
    """The path of a constant array of a pass."""
    return f"constants/{label.replace(' ', '_')}.{name}.raw"


def of_array(dtype: np.dtype[np.generic], shape: tuple[int, ...]) -> Entry:
    """Type and shape of an array in C order; in files it is little-endian."""
    return {"type": dtype.name, "shape": list(shape), "bytes": dtype.itemsize * int(np.prod(shape))}


def of_buffer(buffer: Buffer, schedule: Schedule) -> Entry:
    """A buffer: its quantities, its place in the memory, and the launches between which it is needed."""
    resource, memory = buffer.resource, schedule.memory
    layout = schedule.layout.every(resource.spacing)
    used = [number for number, scheduled in enumerate(schedule.passes) if buffer in scheduled.own.values()]
    return {
        "name": resource.name,
        "is_previous": buffer.previous,
        "life": resource.life.name.lower(),
        "spacing": resource.spacing,
        "size": layout.size.tolist(),
        "bytes": memory.nbytes(resource),
        "memory": list(memory.pieces(buffer)),
        "launches": [min(used, default=0), max(used, default=0)],
        "quantities": [
            of_quantity(quantity, layout.nbytes(8 * resource.begin(quantity.name))) for quantity in resource.quantities
        ],
    }


def of_quantity(quantity: Quantity, offset: int) -> Entry:
    """A quantity of a buffer and its offset in bytes; its planes are ordered by signal, then by channel."""
    return {
        "name": quantity.name,
        "format": quantity.format.name.lower(),
        "type": quantity.format.dtype.name,
        "channels": quantity.channels,
        "signals": quantity.signals,
        "is_light": quantity.is_light,
        "offset": offset,
    }


def of_fill(fill: Fill, memory: Memory) -> Entry:
    """A part of the memory that is filled at a cut."""
    pattern = fill.value.astype(fill.value.dtype.newbyteorder("<")).tobytes()
    return {
        "buffer": fill.buffer.resource.name,
        "memory": list(memory.pieces(fill.buffer)),
        "offset": fill.offset,
        "bytes": fill.nbytes,
        "value": fill.value.item(),
        "pattern": list(pattern),
    }


def of_launch(scheduled: ScheduledPass, schedule: Schedule) -> Entry:
    """A kernel launch."""
    group = schedule.tuning.work_group
    return {
        "label": scheduled.entry.label,
        "program": sources(schedule.pipeline).index(scheduled.entry.source),
        "kernel": scheduled.entry.kernel,
        "arguments": [{"name": name, **of_argument(name, scheduled, schedule)} for name in scheduled.entry.arguments],
        "work_items": list(scheduled.work_items),
        "local_size": list(group),
        "global_size": list(whole_groups(scheduled.work_items, group)),
    }


def of_argument(name: str, scheduled: ScheduledPass, schedule: Schedule) -> Entry:
    """One argument of a kernel."""
    if name in scheduled.own:
        buffer = scheduled.own[name]
        return {"kind": "memory", "memory": list(schedule.memory.pieces(buffer)), "buffer": buffer.resource.name}
    if name in scheduled.user:
        return {"kind": "array", "array": list(schedule.arrays).index(scheduled.user[name])}
    if name in scheduled.entry.arrays:
        files = list(constant_arrays(schedule.pipeline))
        return {"kind": "constant", "constant": files.index(constant_file(scheduled.entry.label, name))}
    if name in IN_PLACE:
        return of_value(np.int32(IN_PLACE[name]))
    if name in scheduled.entry.per_frame:
        return {"kind": name}
    return of_value(scheduled.values[name])


def of_value(value: np.ndarray | np.generic) -> Entry:
    """A number, or four integers."""
    if isinstance(value, np.ndarray):
        return {"kind": "int4", "value": value.tolist()}
    return {"kind": "int" if isinstance(value, np.integer) else "float", "value": value.item()}
