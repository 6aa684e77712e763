"""Tables say what was found, mark the best, and leave blank what is not there."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path

from benchmarks import quality_tables
from benchmarks.contest import Result, Row
from benchmarks.presentation import MARK
from svgf_cl.compare.judge import Findings

GOOD = Findings(
    psnr=40.0,
    ssim=0.99,
    flip=0.02,
    relmse=0.01,
    relmse_trimmed=0.005,
    bias=-0.012,
    temporal=0.003,
    temporal_on_surfaces=0.002,
    flicker=0.001,
    warped=0.004,
    edges=0.97,
    shadows=0.9,
    moving_shadows=0.8,
    detail=0.7,
    ghost=0.1,
    unsettled=0.05,
    lags=(0, 3),
)
BAD = replace(GOOD, psnr=20.0, flip=0.2, temporal=0.004, moving_shadows=math.nan, lags=(11, None))
ROWS = {"noisy": Row(BAD, None, None), "svgf": Row(GOOD, 1.5, 1.25)}


def result(scene: str, *, jitter: bool = False, rows: dict[str, Row] = ROWS) -> Result:
    return Result(scene, jitter, range(8, 24), 38.04, rows)


def test_a_scene_is_a_table_with_every_figure() -> None:
    table = quality_tables.scene_table(result("swing"))
    assert table.title == "swing, rays through pixel centres, frames 8 to 23, halves of the truth differ by 38.0 dB"
    noisy, svgf = table.rows
    assert len(noisy) == len(svgf) == len(table.columns)
    assert " | ".join(svgf) == (
        "svgf | 40.00 | 0.990 | 0.0200 | 0.0100 | 0.00300 | 0.00200 | -1.2 | 97 | 90 | 80 | 0, 3 | 1.50 | 1.25"
    )
    assert list(noisy[-4:]) == ["", "11, ∞", "", ""]


def test_the_summary_marks_the_best_of_each_scene_and_of_the_mean() -> None:
    other = {"noisy": ROWS["svgf"], "svgf": Row(replace(GOOD, psnr=30.0), 1.0, 1.0)}
    tables = quality_tables.summary([result("swing"), result("/a/sponza", rows=other), result("swing", jitter=True)])
    assert [table.title for table in tables] == [
        f"{title}, {rays}"
        for rays in ("rays through pixel centres", "jittered rays")
        for title in ("PSNR dB ↑", "FLIP ↓", "temporal error ↓")
    ]
    assert tables[0].columns == ("filter", "swing", "sponza", "mean")
    assert tables[0].rows == [
        ["noisy", "20.00", f"40.00{MARK}", "30.00"],
        ["svgf", f"40.00{MARK}", "30.00", f"35.00{MARK}"],
    ]
    assert tables[1].rows[1][1] == f"0.0200{MARK}"


def test_json_holds_everything_and_null_for_what_is_not_there(tmp_path: Path) -> None:
    quality_tables.write_json(tmp_path / "a.json", {"size": "64x36"}, [result("swing")])
    record = json.loads((tmp_path / "a.json").read_text())
    assert record["about"] == {"size": "64x36"}
    (scene,) = record["scenes"]
    assert (scene["scene"], scene["jitter"], scene["frames"]) == ("swing", False, [8, 24])
    assert scene["rows"]["noisy"]["moving_shadows"] is None
    assert scene["rows"]["noisy"]["lags"] == [11, None]
    assert scene["rows"]["svgf"] | {"psnr": 40.0, "call": 1.5, "device": 1.25} == scene["rows"]["svgf"]
