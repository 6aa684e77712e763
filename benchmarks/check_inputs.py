"""Writes docs/checking_inputs.md: which of twenty mistakes `svgf-cl check` finds, in which scene."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from benchmarks.command import run
from benchmarks.mistakes import MISTAKES, ROOM, Mistake, Taken, good_sequence
from svgf_cl import check_sequence
from svgf_cl.check import CHECKS, Report
from svgf_cl.cli.console import tracked
from svgf_cl.frame import extent
from svgf_cl.io.atomic import written_whole
from svgf_cl_tracer import BUILTIN

TARGET = Path("docs/checking_inputs.md")
SHAPE = (180, 320)
FRAMES = 7  # of which the first only leads to the second
DEVELOPED = (ROOM, "cornell", "mirror", "contrast")
FOUND, ALSO, UNTOLD, MISSED = "yes", "yes, and more", "-", "**no**"

INTRODUCTION = """# Checking inputs

Made by `python -m benchmarks.check_inputs`; do not edit.

Most trouble with a denoiser is trouble with what it is given.
`svgf-cl check FRAMES` looks for it in the frames, before anything is denoised:

```sh
svgf-cl check out/box                # a table of what is wrong: exit code 1 where anything is
svgf-cl check out/box -o fields.png  # and a picture of every field, and of where motion leads
```

```python
from svgf_cl import check_frame, check_sequence

report = check_sequence(frames)  # Report: findings, unknown, passed
report = check_frame(frame, previous)
```

A finding names the field, what is wrong with it, the figures that show it, what svgf_cl expects, and what to do.
An error spoils the picture.
A warning costs quality; it is no mistake if you meant it so.
What the frames cannot tell is listed as not checked, and never as passed: the sign of motion where nothing moves.
A required field that is missing, or a field of a wrong shape, is refused at once.
Eight frames of a moving camera are plenty.

`Report.looked_at` says which fields were there to be looked at.
Some checks need a picture of 10,000 pixels or more; of a smaller one they are listed as not checked.
Of pictures with more than 240 rows, most checks look at every second or third row and column, and so on.
`svgf-cl denoise` looks at the first eight frames in the same way and warns; `--no-check` turns that off.

## How it is told

The fields of a frame depend on each other: motion, for example, must lead to the same surface in the frame before.
For every known mistake there is a way to undo it.
If the fields go together clearly better after that, the mistake was made.
A check that relies on a field which is wrong waits until that field is mended.

- **motion** is right where normals, albedo and steps of depth are found again in the frame before (`check/motion.py`).
  Jitter is what no camera's movement explains: a rotation and a parallax leave no offset (`check/camera.py`).
- **depth** is right where planes, told by their normals, are plane (`check/depth.py`).
- **normals** of the world stay what they are when the camera turns (`check/surfaces.py`); so do **ids**.
- **albedo and colour** are both linear where neighbours on a surface have colours in the ratio of their albedos, noise
  averaged out (`check/shading.py`).
- **fields of one frame** have their edges in the same places (`check/alignment.py`).
- The rest are plain numbers (`check/values.py`).
"""

TABLE = f"""## What is found

{FRAMES - 1} frames of each built-in scene, {extent(SHAPE)}, 1 sample per pixel, with color, albedo, normal, depth,
motion, id and emission, from the middle of its sequence; and the closed-form room. Into each go twenty mistakes, one at
a time. "{FOUND}": found and called by its name, and no other field suspected. "{ALSO}": another one is, too.
"{UNTOLD}": the report says that it could not be checked. {MISSED}: passed for right. Thresholds were set on
{", ".join(DEVELOPED)}; false alarms on the other scenes, held out at first, changed some of them since.
"""


def check_inputs(
    scenes: Annotated[
        list[str], typer.Argument(metavar="[SCENE]...", help="More scenes: files, or folders with a scene.json.")
    ] = [],  # noqa: B006  # never changed
) -> None:
    """Make twenty mistakes in every built-in scene, and write which are found."""
    columns = {}
    names = [ROOM, *BUILTIN, *scenes]
    for scene in tracked(names, len(names), "checking"):
        columns[Path(scene).name] = outcomes(good_sequence(scene, SHAPE, FRAMES))
    with written_whole(TARGET) as aside:
        aside.write_text(f"{INTRODUCTION}\n{TABLE}\n{table(columns)}\n{checks()}", encoding="utf-8")
    print(f"{TARGET}: {len(columns)} scenes")


def outcomes(good: Sequence[Taken]) -> dict[str, str]:
    """What becomes of the good frames, and of each mistake."""
    report = check_sequence(taken.frame for taken in good[1:])
    found = {"none": ", ".join(f"{f.field}: {f.what}" for f in report.findings) or "nothing found"}
    return found | {name: outcome(mistake, check_sequence(mistake.made_in(good))) for name, mistake in MISTAKES.items()}


def outcome(mistake: Mistake, report: Report) -> str:
    """Whether a mistake was found, and whether alone; if not, whether the report says that it cannot be told."""
    if mistake.named_in(report):
        return FOUND if all(finding.field == mistake.field for finding in report.findings) else ALSO
    return UNTOLD if any(unknown.topic == mistake.check.topic for unknown in report.unknown) else MISSED


def table(columns: dict[str, dict[str, str]]) -> str:
    """A markdown table with one row a mistake."""
    rows = [["mistake", *columns], ["---"] * (1 + len(columns))]
    rows += [[name, *(column[name] for column in columns.values())] for name in ("none", *MISTAKES)]
    named = [sum(cell in (FOUND, ALSO) for cell in column.values()) for column in columns.values()]
    rows.append([f"found, of {len(MISTAKES)}", *map(str, named)])
    return "\n".join(f"| {' | '.join(row)} |" for row in rows) + "\n"


def checks() -> str:
    """All that is looked at."""
    return "## All checks\n\n" + "\n".join(f"- {check.topic}" for check in CHECKS) + "\n"


def main() -> None:
    """Run the command."""
    run(check_inputs, "benchmarks.check_inputs")


if __name__ == "__main__":
    main()
