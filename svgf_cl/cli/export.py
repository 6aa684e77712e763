"""``svgf-cl export``: writes a filter as kernels and a plan, for a renderer that runs it without Python."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from svgf_cl.cli.options import FilterName, SettingTexts, Size, parse_settings, parse_size
from svgf_cl.device.arguments import layout_of
from svgf_cl.device.devices import default_device
from svgf_cl.device.layout import Layout
from svgf_cl.device.tuning import CPU_TUNING, GPU_TUNING, Tuning, best_tuning
from svgf_cl.errors import SvgfError, shown
from svgf_cl.export.folder import write_plan
from svgf_cl.export.preprocess import check_preprocessor
from svgf_cl.filters import DEFAULT
from svgf_cl.filters.filter import Filter
from svgf_cl.filters.signals import COLOR, DIRECT, INDIRECT, Inputs
from svgf_cl.frame import Shape, extent
from svgf_cl.io.atomic import check_new, output_folder
from svgf_cl.schedule import Schedule

SPLIT = (DIRECT, INDIRECT)
OPTIONAL = ("albedo", "emission", "id", *(signal.field for signal in SPLIT))
TUNINGS = {"gpu": GPU_TUNING, "cpu": CPU_TUNING}


def export(
    output: Annotated[Path, typer.Option("-o", "--output", metavar="DIR", help="Folder to make.")],
    size: Size,
    fields: Annotated[
        str,
        typer.Option(
            metavar="NAME,...",
            help="Fields of frames in addition to color, normal, depth and motion: "
            f"{', '.join(OPTIONAL)}. direct and indirect must come together, and replace color.",
        ),
    ] = "",
    motion: Annotated[
        int,
        typer.Option(min=2, max=3, metavar="2|3", help="Components of motion; the third is the change of depth."),
    ] = 2,
    filter_: FilterName = DEFAULT.name,
    set_: SettingTexts = [],  # noqa: B006  # never changed; typer needs the default here
    kind: Annotated[
        str | None,
        typer.Option(
            "--for",
            metavar="gpu|cpu",
            help="Use the tuning for most GPUs or for most CPUs; then no device is needed. By default, the tuning that "
            "svgf-cl tune stored for the device here, else that for most devices of its kind.",
        ),
    ] = None,
) -> None:
    """Write the kernels and a plan, for a renderer without Python.

    The folder has the OpenCL kernels of one filter, which can be compiled as they are, and plan.json. The plan lists
    the memory to allocate, the kernels to launch in order with all their arguments, and what to do at a cut.
    docs/export.md describes it, and examples/c_host runs it from C. A plan is for frames of one size with one set of
    fields. It runs on any device, whatever its tuning.

    \b
    Examples:
      svgf-cl export --size 1280x720 --fields albedo,id --for gpu -o plan
      svgf-cl export --size 640x360 --fields albedo,direct,indirect --motion 3 --set taa=on -o plan
      svgf-cl export --size 1920x1080 --filter svgf --set iterations=4 -o plan-svgf
    """
    shape, inputs, settings = parse_size(size), parse_fields(fields, motion), parse_settings(filter_, set_)
    check_preprocessor()
    check_new(output)
    output_folder(output.parent)
    tuning = parse_kind(kind)
    schedule = Schedule(settings.pipeline(inputs), parse_layout(shape, tuning, settings), tuning)
    write_plan(output, schedule, settings)
    mebibytes = sum(schedule.memory.sizes) / 2**20
    print(
        f"{output}: {settings.name} for {extent(shape)} frames with {', '.join(schedule.pipeline.fields)}: "
        f"{len(schedule.passes)} launches, {mebibytes:.0f} MiB of device memory; {tuning}"
    )


def parse_fields(text: str, motion: int) -> Inputs:
    """Read a text such as ``albedo,id`` as the fields of frames; raise `SvgfError` for a name not in `OPTIONAL`."""
    names = [name.strip() for name in text.split(",")] if text.strip() else []
    for name in names:
        if name not in OPTIONAL:
            raise SvgfError(
                f"--fields: expected names out of {', '.join(OPTIONAL)}, with commas between them, got {shown(name)}"
            )
    split = tuple(signal for signal in SPLIT if signal.field in names)
    if split and split != SPLIT:
        raise SvgfError(f"--fields: expected both of direct and indirect, or neither, got {split[0].field} alone")
    given = {name: name in names for name in ("albedo", "emission", "id")}
    return Inputs(signals=split or (COLOR,), motion=motion, **given)


def parse_layout(shape: Shape, tuning: Tuning, settings: Filter) -> Layout:
    """Return the layout of an image; raise `SvgfError` if it is too large for a plan, which has no tiles."""
    try:
        return layout_of(shape, tuning, settings)
    except SvgfError as error:
        raise SvgfError(
            f"--size: expected at most about 11000x11000 pixels, because indices have 32 bits, got {extent(shape)}"
        ) from error


def parse_kind(text: str | None) -> Tuning:
    """Return the tuning for most devices of a kind, or for None that of the device here."""
    if text is None:
        return best_tuning(default_device())
    if text not in TUNINGS:
        raise SvgfError(f"--for: expected {' or '.join(TUNINGS)}, got {shown(text)}")
    return TUNINGS[text]
