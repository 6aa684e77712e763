"""``svgf-cl export`` as people use it, rightly and wrongly."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from svgf_cl.cli import export
from svgf_cl.device.tuning import GPU_TUNING
from tests.command_line import contents, run

OPTIONAL = "--fields: expected names out of albedo, emission, id, direct, indirect, with commas between them, got "
SMALL = ("export", "--size", "40x30", "--for", "gpu")


def test_it_says_what_it_wrote(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    given = ("--fields", "albedo, id,direct,indirect", "--motion", "3", "--filter", "svgf", "--set", "iterations=2")
    assert run(*SMALL, *given, "-o", tmp_path / "plan") == 0
    said = capsys.readouterr().out
    assert "plan: svgf for 40x30 frames with direct, indirect, albedo, normal, depth, id, motion: 6 launches" in said
    plan = json.loads((tmp_path / "plan" / "plan.json").read_text())
    assert plan["filter"]["name"] == "svgf"
    assert plan["filter"]["settings"]["iterations"] == 2
    assert plan["image"] == {"width": 40, "height": 30, "halo": 32}
    assert {array["name"]: array["shape"] for array in plan["arrays"]}["motion"] == [30, 40, 3]
    assert tuple(plan["tuning"]["work_group"]) == GPU_TUNING.work_group


def test_for_a_kind_of_device_none_is_needed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delattr(export, "default_device")
    assert run(*SMALL, "-o", tmp_path / "gpu") == 0
    assert run("export", "--size", "40x30", "--for", "cpu", "-o", tmp_path / "cpu") == 0
    assert contents(tmp_path / "gpu") != contents(tmp_path / "cpu")


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        (("--size", "40"), "--size: expected WIDTHxHEIGHT in pixels such as 640x360, got '40'"),
        (
            ("--size", "30000x30000"),
            "--size: expected at most about 11000x11000 pixels, because indices have 32 bits",
        ),
        (("--fields", "albdo"), f"{OPTIONAL}'albdo'"),
        (
            ("--fields", "albedo,"),
            "--fields: expected names out of albedo, emission, id, direct, indirect, with commas",
        ),
        (("--fields", "color"), f"{OPTIONAL}'color'"),
        (("--fields", "direct"), "--fields: expected both of direct and indirect, or neither, got direct alone"),
        (("--motion", "4"), "--motion"),
        (("--filter", "svg"), "--filter: expected kalman or"),
        (("--set", "alpha=1"), "--set: expected NAME=VALUE with a name among"),
        (("--set", "iterations=9"), "iterations: expected a whole number in 1..5, got 9"),
        (("--for", "fpga"), "--for: expected gpu or cpu, got 'fpga'"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, tuple) else "",
)
def test_wrong_input_is_refused(
    wrong: tuple[str, ...], words: str, tmp_path: Path, refused: Callable[..., None]
) -> None:
    refused(words, *SMALL, *wrong, "-o", tmp_path / "plan")
    assert list(tmp_path.iterdir()) == []


def test_what_is_there_stays(tmp_path: Path, refused: Callable[..., None]) -> None:
    there = tmp_path / "plan"
    there.mkdir()
    refused("plan: expected a new folder, but it is there already; delete it, or name another", *SMALL, "-o", there)
    assert list(there.iterdir()) == []


def test_a_folder_that_cannot_be_made_is_told_before_any_work(
    tmp_path: Path, refused: Callable[..., None], monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "file").touch()
    monkeypatch.delattr(export, "write_plan")
    refused("file: cannot be a folder for the output (File exists)", *SMALL, "-o", tmp_path / "file" / "plan")


def test_without_size_it_says_so(tmp_path: Path, refused: Callable[..., None]) -> None:
    refused("--size", "export", "-o", tmp_path / "plan")
