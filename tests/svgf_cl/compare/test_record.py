"""What was found is written whole, and parts of a run are read back as they were."""

from __future__ import annotations

import csv
import io
import json
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from svgf_cl.compare import record
from svgf_cl.compare.measures import MEASURES
from svgf_cl.compare.page import Entry, Page, Scene
from svgf_cl.compare.record import measured, part_name, read_part, results, table, write_part
from svgf_cl.io.atomic import write_text

VALUES = {"psnr": math.inf, "ssim": 0.1 + 0.2, "ghost": math.nan, "bias": -math.inf}
CURVES = {"psnr": [40.0, math.inf], "temporal": [math.nan, 0.25]}
SCENE = Scene(
    name='a "room", with <all>\n',
    note="",
    frames=[8, 9],
    shown=9,
    size=(18, 32),
    crop=(4, 5, 8, 9),
    row=9,
    entries=[
        Entry("svgf,taps=5x5", VALUES, CURVES, 1.25, b"\x89PNG\0\xff", b"heat", b"clip", b"profile"),
        Entry("noisy", {"psnr": 20.0}, {}, None, b"noisy", b"", None, None),
        Entry("reference", {}, {}, None, b"truth", None, None, None),
    ],
    reference="reference",
    noisy="noisy",
)
BARE = replace(SCENE, crop=None, row=None, noisy=None)
SHOWN = [each for each in MEASURES if each.key in VALUES]
PAGE = Page("Comparison", {"command": "svgf-cl compare"}, SHOWN, [SCENE])


def refused_constant(text: str) -> None:
    pytest.fail(f"{text} is no JSON")


def test_json_holds_every_figure_null_for_none_and_a_word_for_infinity() -> None:
    found = json.loads(results(PAGE), parse_constant=refused_constant)
    assert found["about"] == {"command": "svgf-cl compare"}
    assert list(found["measures"]) == [each.key for each in SHOWN]
    assert found["measures"]["psnr"] == {"title": "PSNR", "unit": "dB", "meaning": "error as shown"}
    (scene,) = found["scenes"]
    assert (scene["name"], scene["size"], scene["frames"]) == (SCENE.name, [32, 18], [8, 9])
    assert list(scene["filters"]) == ["svgf,taps=5x5", "noisy"]
    assert scene["filters"]["svgf,taps=5x5"] == {
        "milliseconds": 1.25,
        "values": {"psnr": "inf", "ssim": 0.1 + 0.2, "ghost": None, "bias": "-inf"},
        "curves": {"psnr": [40.0, "inf"], "temporal": [None, 0.25]},
    }


def test_csv_has_a_row_for_each_scene_and_filter() -> None:
    rows = list(csv.DictReader(io.StringIO(table(PAGE))))
    assert list(rows[0]) == ["scene", "filter", *(each.key for each in SHOWN), "milliseconds"]
    assert [row["filter"] for row in rows] == ["svgf,taps=5x5", "noisy"]
    assert {row["scene"] for row in rows} == {SCENE.name}
    assert (rows[0]["psnr"], float(rows[0]["ssim"]), rows[0]["ghost"]) == ("inf", 0.1 + 0.2, "")
    assert (rows[1]["psnr"], rows[1]["ssim"], rows[1]["milliseconds"]) == ("20.0", "", "")


def test_what_is_no_text_is_written_as_python_shows_it(tmp_path: Path) -> None:
    """Files and folders of anyone may be called so, and scenes are called like them."""
    write_text(tmp_path / "a.csv", table(replace(PAGE, scenes=[replace(SCENE, name="r\udcf6om")])))
    assert "r\\udcf6om" in (tmp_path / "a.csv").read_text("utf-8")


def test_measures_are_those_that_anything_has_a_value_of() -> None:
    assert [each.key for each in measured([SCENE])] == ["psnr", "ssim", "bias"]
    nothing = replace(SCENE, entries=[Entry("a", {"psnr": None, "ssim": math.nan}, {}, None, b"", None, None, None)])
    assert measured([nothing]) == []
    assert [each.key for each in measured([nothing, SCENE])] == ["psnr", "ssim", "bias"]


@pytest.mark.parametrize("scene", [SCENE, BARE])
def test_a_part_is_read_back_as_it_was(scene: Scene, tmp_path: Path) -> None:
    write_part(tmp_path / "part.json", scene)
    found = read_part(tmp_path / "part.json")
    assert found is not None
    # NaN, which equals nothing, is that of the math module again.
    assert repr(found) == repr(scene)
    assert replace(found, entries=found.entries[1:]) == replace(scene, entries=scene.entries[1:])


def change(found: dict[str, Any], path: str, value: object) -> dict[str, Any]:
    """The record with something else at a place in it."""
    *outer, last = (int(name) if name.isdecimal() else name for name in path.split("."))
    place: Any = found
    for name in outer:
        place = place[name]
    place[last] = value
    return found


@pytest.mark.parametrize(
    ("place", "value"),
    [
        ("entries", 3),
        ("entries", [3]),
        ("entries.0.values", None),
        ("entries.0.values.psnr", "much"),
        ("entries.0.curves.psnr", 3),
        ("entries.0.picture", "not base64"),
        ("entries.0.picture", 3),
        ("entries.0.taste", "sour"),
        ("size", None),
        ("crop", 3),
    ],
)
def test_a_part_that_holds_something_else_is_ignored(place: str, value: object, tmp_path: Path) -> None:
    path = tmp_path / "part.json"
    write_part(path, SCENE)
    path.write_text(json.dumps(change(json.loads(path.read_text()), place, value)))
    assert read_part(path) is None


@pytest.mark.parametrize("text", ["", "{", "{}", "[]", "3", "null", '"entries"', "\xff", "[" * 100_000])
def test_what_is_no_part_is_ignored(text: str, tmp_path: Path) -> None:
    (tmp_path / "part.json").write_text(text, encoding="latin-1")
    assert read_part(tmp_path / "part.json") is None


def test_a_part_that_is_cut_off_or_not_there_is_ignored(tmp_path: Path) -> None:
    path = tmp_path / "part.json"
    assert read_part(path) is None
    assert read_part(tmp_path) is None
    write_part(path, SCENE)
    whole = path.read_bytes()
    for length in (1, len(whole) // 2, len(whole) - 1):
        path.write_bytes(whole[:length])
        assert read_part(path) is None


def test_a_part_goes_by_all_that_went_into_it(monkeypatch: pytest.MonkeyPatch) -> None:
    def name(
        identity: str = "room", rivals: tuple[str, ...] = ("a", "b"), stops: float = 0, device: str = "cpu"
    ) -> str:
        return part_name(identity, rivals, stops, device)

    usual = name()
    assert name() == usual
    assert usual.isalnum()
    others = {name("hall"), name(rivals=("b", "a")), name(rivals=("a",)), name(stops=1), name(device="gpu")}
    monkeypatch.setattr(record, "why_no_flip", lambda: "it is missing")
    others.add(name())
    monkeypatch.undo()
    monkeypatch.setattr(record, "code_digest", lambda: "newer")
    others.add(name())
    assert len(others | {usual}) == 8


def test_weights_and_code_are_a_part_of_its_name(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    digest = record.code_digest.__wrapped__
    monkeypatch.setattr("svgf_cl.__file__", str(tmp_path / "__init__.py"))
    names = {digest()}
    for file in ("a.py", "filters/b.py", "filters/c.json"):
        (tmp_path / file).parent.mkdir(exist_ok=True)
        (tmp_path / file).write_text("x")
        names.add(digest())
    (tmp_path / "page.html").touch()
    names.add(digest())
    assert len(names) == 4
