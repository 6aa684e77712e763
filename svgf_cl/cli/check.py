"""``svgf-cl check``: what is wrong with frames, before they are denoised."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from svgf_cl.check import Inspection
from svgf_cl.cli.console import show, tracked
from svgf_cl.cli.options import AllowGaps, Frames
from svgf_cl.cli.remarks import reading
from svgf_cl.errors import SvgfError
from svgf_cl.frame import Frame
from svgf_cl.io.atomic import output_file
from svgf_cl.io.display import write_image
from svgf_cl.io.sequence import after_gaps, find_frames
from svgf_cl.io.shot import read_shot, shared_window


def check(
    frames: Frames,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="FILE", help="Also draw the fields of the last frame into a PNG file."),
    ] = None,
    allow_gaps: AllowGaps = False,
) -> None:
    """Look for what is wrong with the frames of a shot, before they are denoised.

    It finds motion that points the other way, normals in view space, the depth of a depth buffer, colour that was
    encoded for a display, and more. It needs frames of a moving camera; eight are plenty. What the frames cannot tell
    is listed as not checked. Exit code 1 where anything is wrong.

    \b
    Examples:
      svgf-cl check out/box
      svgf-cl check shot.0100.exr shot.0101.exr shot.0102.exr shot.0103.exr -o fields.png
    """
    if output and output.suffix != ".png":
        raise SvgfError(f"--output: expected a file named *.png, got {output}")
    if output:
        output_file(output)
    sources = find_frames(frames, allow_gaps=allow_gaps)
    inspection, cuts = Inspection(), after_gaps(sources)
    last: list[Frame] = []
    shot = tracked(read_shot(sources, shared_window(sources)), len(sources), "checking")
    for path, (image, frame) in zip(sources, shot, strict=True):
        if not last:
            print(reading(image.planes))
        if path in cuts:
            inspection.cut()
        inspection.add(frame)
        last = [*last[-1:], frame]
    report = inspection.report()
    if output:
        draw(output, last)
    title = f"{len(sources)} frames: {len(report.findings)} findings, {len(report.passed)} checks passed"
    if report.findings:
        rows = [(f.field, f.severity, f.what, f.measured, f.expected, f.cure) for f in report.findings]
        show(title, ("field", "severity", "found", "measured", "expected", "to do"), rows, words=6)
    else:
        print(title)
    for line in report.unknown:
        print(line)
    raise typer.Exit(1 if report.findings else 0)


def draw(path: Path, last: list[Frame]) -> None:
    """Write the contact sheet of the last of some frames."""
    try:
        from svgf_cl.check.sheet import sheet
    except ImportError as error:
        raise SvgfError(f"--output: drawing takes Pillow; pip install pillow ({error})") from error
    write_image(path, sheet(last[0], last[-1]))
