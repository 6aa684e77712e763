"""Writes docs/checking_inputs.md: which of twenty mistakes `svgf-cl check` finds in each scene."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from benchmarks.command import run
from benchmarks.markdown import markdown
from benchmarks.mistakes import MISTAKES, ROOM, Mistake, Taken, good_sequence
from svgf_cl import check_sequence
from svgf_cl.check import CHECKS, Report
from svgf_cl.cli.console import tracked
from svgf_cl.frame import extent
from svgf_cl.io.atomic import write_text
from svgf_cl_tracer import BUILTIN

TARGET = Path("docs/checking_inputs.md")
SHAPE = (180, 320)
FRAMES = 7  # the first frame is only the previous one of the second
DEVELOPED = (ROOM, "cornell", "mirror", "contrast")
FOUND, ALSO, UNTOLD, MISSED = "yes", "yes, and more", "-", "**no**"

INTRODUCTION = """# Checking inputs

Made by `python -m benchmarks.check_inputs`; do not edit.

If a denoised picture looks wrong, the input is usually the reason.
`svgf-cl check FRAMES` looks for mistakes in the frames before anything is denoised:

```sh
svgf-cl render cornell -o out/box    # frames to check, of a built-in scene
svgf-cl check out/box                # a table of all mistakes; the exit code is 1 if there are any
svgf-cl check out/box -o fields.png  # also draws every field, and the previous frame moved by the motion vectors
```

```python
from svgf_cl import check_frame, check_sequence

report = check_sequence(frames)  # Report: findings, unknown, passed
report = check_frame(frame, previous)
```

A finding names the field and the problem, gives the figures that show it, and says what svgf_cl expects and what to do.
An error spoils the picture.
A warning means lower quality; ignore it if the input is meant to be like this.
Some frames cannot show a mistake: where nothing moves, the sign of motion is unknown.
The report lists such checks as "not checked", and never as passed.
A missing required field or a field of a wrong shape is an error at once.
Eight frames of a moving camera are enough.

`Report.looked_at` says which fields the frames have.
Some checks need a picture of at least 10,000 pixels; in a smaller one they are listed as not checked.
In a picture with more than 240 rows, most checks read only every second or third row and column, and so on.
`svgf-cl denoise` checks the first eight frames in the same way and prints warnings; `--no-check` turns that off.

## How it works

The fields of a frame depend on each other.
For example, motion must lead to the same surface in the previous frame.
For every known mistake there is a correction.
If the fields fit together clearly better after the correction, the mistake was made.
If a check needs a field that is wrong, it is listed as not checked until you correct that field.

- **Motion** is right if it leads to the same normals, albedo and depth edges in the previous frame (`check/motion.py`).
  It contains jitter if it has an offset that neither a turn nor a movement of the camera explains (`check/camera.py`).
- **Depth** is right if neighbours with the same normal lie on one plane (`check/depth.py`).
- **Normals** in world space and **ids** do not change when the camera turns (`check/surfaces.py`).
- **Albedo and colour** are both linear if neighbours on a surface have colours in the ratio of their albedos.
  The noise is averaged out first (`check/shading.py`).
- **Fields of one frame** have their edges in the same places (`check/alignment.py`).
- The other checks compare values with their allowed range (`check/values.py`).
"""

TABLE = f"""## What is found

The test uses {FRAMES - 1} frames from the middle of each built-in scene, and of a room computed by formulas (`room`).
Frames are {extent(SHAPE)} with 1 sample per pixel, and have color, albedo, normal, depth, motion, id and emission.
Twenty mistakes are made in each scene, one at a time.

- "{FOUND}": the report names this mistake and suspects no other field.
- "{ALSO}": the report names this mistake, and suspects another field too.
- "{UNTOLD}": the report lists this check as not checked.
- {MISSED}: the report does not notice the mistake.

The thresholds of the checks were chosen on {", ".join(DEVELOPED)}.
The other scenes were first kept apart as a test; later, false alarms on them changed some thresholds.
"""


def check_inputs(
    scenes: Annotated[
        list[str], typer.Argument(metavar="[SCENE]...", help="More scenes: files, or folders with a scene.json.")
    ] = [],  # noqa: B006  # never changed
) -> None:
    """Make twenty mistakes in every built-in scene, and write which of them are found."""
    columns = {}
    names = [ROOM, *BUILTIN, *scenes]
    for scene in tracked(names, len(names), "checking"):
        columns[Path(scene).name] = outcomes(good_sequence(scene, SHAPE, FRAMES))
    write_text(TARGET, f"{INTRODUCTION}\n{TABLE}\n{table(columns)}\n{checks()}")
    print(f"{TARGET}: {len(columns)} scenes")


def outcomes(good: Sequence[Taken]) -> dict[str, str]:
    """The result for the good frames, and for each mistake."""
    report = check_sequence(taken.frame for taken in good[1:])
    found = {"none": ", ".join(f"{f.field}: {f.what}" for f in report.findings) or "nothing found"}
    return found | {name: outcome(mistake, check_sequence(mistake.made_in(good))) for name, mistake in MISTAKES.items()}


def outcome(mistake: Mistake, report: Report) -> str:
    """Whether the mistake was found, and no other; if not found, whether the report says that it was not checked."""
    if mistake.named_in(report):
        return FOUND if all(finding.field == mistake.field for finding in report.findings) else ALSO
    return UNTOLD if any(unknown.topic == mistake.check.topic for unknown in report.unknown) else MISSED


def table(columns: dict[str, dict[str, str]]) -> str:
    """A markdown table with one row for each mistake."""
    rows = [[name, *(column[name] for column in columns.values())] for name in ("none", *MISTAKES)]
    named = [sum(cell in (FOUND, ALSO) for cell in column.values()) for column in columns.values()]
    rows.append([f"found, of {len(MISTAKES)}", *map(str, named)])
    return markdown(("mistake", *columns), rows)


def checks() -> str:
    """The list of all checks."""
    return "## All checks\n\n" + "\n".join(f"- {check.topic}" for check in CHECKS) + "\n"


def main() -> None:
    """Run the command."""
    run(check_inputs, "benchmarks.check_inputs")


if __name__ == "__main__":
    main()
