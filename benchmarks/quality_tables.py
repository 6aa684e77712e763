"""What `benchmarks.quality` found, as tables and JSON."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.contest import Result, Row
from benchmarks.presentation import MARK
from svgf_cl.bench.tables import Table
from svgf_cl.compare.judge import Findings
from svgf_cl.io.atomic import written_whole

RAYS = {False: "rays through pixel centres", True: "jittered rays"}

COLUMNS = (
    *("PSNR ↑", "SSIM ↑", "FLIP ↓", "relMSE ↓", "temporal ↓", "surfaces ↓", "bias %"),
    *("edges %", "shadows %", "moving %", "lag", "ms", "device ms"),
)


@dataclass(frozen=True)
class Measure:
    """A figure of the summary; `sign` is 1 where more is better, else -1."""

    title: str
    of: Callable[[Findings], float]
    spec: str
    sign: int


SUMMARY = (
    Measure("PSNR dB ↑", lambda found: found.psnr, ".2f", 1),
    Measure("FLIP ↓", lambda found: found.flip, ".4f", -1),
    Measure("temporal error ↓", lambda found: found.temporal, ".5f", -1),
)


def scene_table(result: Result) -> Table:
    """Everything about one scene."""
    frames = f"frames {result.frames.start} to {result.frames.stop - 1}"
    noise = f"halves of the truth differ by {result.truth_noise:.1f} dB"
    title = f"{result.scene}, {RAYS[result.jitter]}, {frames}, {noise}"
    return Table(title, ("filter", *COLUMNS), [[name, *figures(row)] for name, row in result.rows.items()])


def figures(row: Row) -> list[str]:
    """A row as printed, in the order of `COLUMNS`."""
    found = row.findings
    errors = [f"{found.psnr:.2f}", f"{found.ssim:.3f}", f"{found.flip:.4f}", f"{found.relmse:.4f}"]
    changes = [written(change, ".5f") for change in (found.temporal, found.temporal_on_surfaces)]
    kept = [written(100 * share, ".0f") for share in (found.edges, found.shadows, found.moving_shadows)]
    lags = ", ".join("∞" if frames is None else str(frames) for frames in found.lags)
    times = [written(math.nan if time is None else time, ".2f") for time in (row.call, row.device)]
    return [*errors, *changes, written(100 * found.bias, "+.1f"), *kept, lags, *times]


def written(value: float, spec: str) -> str:
    """A figure; nothing where there is none."""
    return "" if math.isnan(value) else format(value, spec)


def summary(results: Sequence[Result]) -> list[Table]:
    """One table for each kind of rays and measure: filters by scenes, and their mean."""
    by_rays = {jitter: [result for result in results if result.jitter == jitter] for jitter in RAYS}
    return [summary_table(some, measure) for some in by_rays.values() if some for measure in SUMMARY]


def summary_table(results: Sequence[Result], measure: Measure) -> Table:
    """Every filter in every scene by one measure; the best of each scene is marked."""
    names = list(results[0].rows)
    found = np.array([[measure.of(result.rows[name].findings) for result in results] for name in names])
    found = np.column_stack((found, found.mean(axis=1)))
    texts = [[format(value, measure.spec) for value in row] for row in found]
    best = [max(column, key=lambda text: measure.sign * float(text)) for column in zip(*texts, strict=True)]
    marked = [[text + MARK * (text == top) for text, top in zip(row, best, strict=True)] for row in texts]
    scenes = [Path(result.scene).name for result in results]
    title = f"{measure.title}, {RAYS[results[0].jitter]}"
    return Table(title, ("filter", *scenes, "mean"), [[name, *row] for name, row in zip(names, marked, strict=True)])


def write_json(path: Path, about: dict[str, str], results: Sequence[Result]) -> None:
    """Write everything that was found so far."""
    record = {"about": about, "scenes": [scene_record(result) for result in results]}
    with written_whole(path) as aside:
        aside.write_text(json.dumps(record, indent=1, allow_nan=False), encoding="utf-8")


def scene_record(result: Result) -> dict[str, Any]:
    """A scene as JSON has it: a figure that there is not is null."""
    rows = {name: asdict(row.findings) | {"call": row.call, "device": row.device} for name, row in result.rows.items()}
    finite = {name: {key: finite_or_none(value) for key, value in row.items()} for name, row in rows.items()}
    frames = [result.frames.start, result.frames.stop]
    about = {"scene": result.scene, "jitter": result.jitter, "frames": frames}
    return {**about, "truth_noise": finite_or_none(result.truth_noise), "rows": finite}


def finite_or_none(value: Any) -> Any:
    """What JSON can hold."""
    return None if isinstance(value, float) and not math.isfinite(value) else value
