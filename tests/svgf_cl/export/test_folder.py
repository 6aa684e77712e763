"""The folder of a plan is written whole or not at all."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from svgf_cl import FileError, Inputs, Settings
from svgf_cl.device.layout import Layout
from svgf_cl.device.tuning import GPU_TUNING
from svgf_cl.export.folder import write_plan
from svgf_cl.schedule import Schedule
from tests.command_line import contents
from tests.disk import files_up_to
from tests.frames import SHAPE

SETTINGS = Settings()
SCHEDULE = Schedule(SETTINGS.pipeline(Inputs()), Layout(*SHAPE), GPU_TUNING)


def test_it_has_all_that_a_host_needs(tmp_path: Path) -> None:
    write_plan(tmp_path / "plan", SCHEDULE, SETTINGS)
    files = contents(tmp_path / "plan")
    plan = json.loads(files["plan.json"])
    assert {*files} == {"plan.json", plan["$schema"], *plan["programs"]}
    assert [path.name for path in tmp_path.iterdir()] == ["plan"]


def test_the_same_plan_is_the_same_bytes(tmp_path: Path) -> None:
    for name in ("one", "two"):
        write_plan(tmp_path / name, SCHEDULE, SETTINGS)
    assert contents(tmp_path / "one") == contents(tmp_path / "two")


def test_a_full_disk_leaves_nothing(tmp_path: Path) -> None:
    with files_up_to(1000), pytest.raises(FileError, match=r"plan: cannot be written \(File too large\)"):
        write_plan(tmp_path / "made" / "plan", SCHEDULE, SETTINGS)
    assert list(tmp_path.iterdir()) == []
