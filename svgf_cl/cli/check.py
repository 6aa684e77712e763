"""``svgf-cl check``: finds mistakes in frames before they are denoised."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from svgf_cl.check import Inspection
from svgf_cl.cli.console import counted, show, tracked
from svgf_cl.cli.options import AllowGaps, Frames
from svgf_cl.cli.reading import reads_frames
from svgf_cl.cli.remarks import described
from svgf_cl.errors import SvgfError
from svgf_cl.frame import Frame
from svgf_cl.io.atomic import output_file
from svgf_cl.io.display import write_image
from svgf_cl.io.reading import ReadAs
from svgf_cl.io.sequence import find_frames
from svgf_cl.io.shot import Shot


@reads_frames
def check(
    frames: Frames,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="FILE", help="Also draw the fields of the last frame into a PNG file."),
    ] = None,
    allow_gaps: AllowGaps = False,
    *,
    how: ReadAs,
) -> None:
    """Find mistakes in the frames of a shot before they are denoised.

    It finds motion with the wrong sign, normals in view space, depth from a depth buffer, colour that was encoded for
    a display, and more. It needs frames of a moving camera; eight are enough. The report lists as "not checked" what
    the frames cannot show. The exit code is 1 if there is any mistake.

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
    shot, inspection = Shot(sources, how), Inspection()
    last: list[Frame] = []
    for index in tracked(range(len(shot)), len(shot), "checking"):
        source = shot.read(index)
        if not last:
            print(described(shot, source))
        if index in shot.cuts:
            inspection.cut()
        inspection.add(source.frame)
        last = [*last[-1:], source.frame]
    report = inspection.report()
    if output:
        draw(output, last)
    counts = counted(len(shot), "frame"), counted(len(report.findings), "finding"), counted(len(report.passed), "check")
    title = "{}: {}, {} passed".format(*counts)
    if report.findings:
        rows = [(f.field, f.severity, f.what, f.measured, f.expected, f.cure) for f in report.findings]
        show(title, ("field", "severity", "found", "measured", "expected", "to do"), rows, words=6)
    else:
        print(title)
    for line in report.unknown:
        print(line)
    raise typer.Exit(1 if report.findings else 0)


def draw(path: Path, last: list[Frame]) -> None:
    """Write the picture of the last frame's fields."""
    try:
        from svgf_cl.check.sheet import sheet
    except ImportError as error:
        raise SvgfError(f"--output: drawing needs Pillow; pip install pillow ({error})") from error
    write_image(path, sheet(last[0], last[-1]))
