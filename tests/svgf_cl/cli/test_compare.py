"""``svgf-cl compare`` as people use it, on pictures and on frames that are there already."""

from __future__ import annotations

import csv
import json
import shutil
import sys
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

pytest.importorskip("flip_evaluator")
pytest.importorskip("jinja2")
pytest.importorskip("skimage")

from svgf_cl.compare import contest
from svgf_cl.io.frames import frame_path, read_frame, write_frame
from svgf_cl.io.pictures import read_picture, write_picture
from tests.command_line import NAMES, run

FIRST = NAMES[0]
REFERENCES = [name.replace("frame", "reference") for name in NAMES]


def cells(text: str) -> list[list[str]]:
    """Of the rows of the tables that were printed."""
    return [[cell.strip() for cell in line.strip("│").split("│")] for line in text.splitlines() if line[:1] == "│"]


# Pictures


def test_compare_finds_a_picture_equal_to_itself(rendered: Path) -> None:
    picture = rendered / FIRST
    assert run("compare", picture, picture, "--fail-below", "psnr=200,ssim=1", "--fail-above", "relmse=0,flip=0") == 0


def test_pictures_have_a_row_each_and_one_for_all(rendered: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run("compare", rendered, rendered) == 0
    said = capsys.readouterr()
    rows = cells(said.out)
    assert [row[0] for row in rows] == ["0", "1", "2", "all"]
    figures = np.array([[float(cell) for cell in row[1:5]] for row in rows])
    np.testing.assert_allclose(figures[3], figures[:3].mean(axis=0), atol=0.006)
    assert rows[0][5] == "", "the temporal error is one of two frames"
    assert float(rows[1][5]) > 0
    assert said.err == "", "neither a progress bar nor warnings where stderr is no terminal"


def test_every_frame_is_held_to_the_limits(rendered: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for number, name in enumerate(REFERENCES):
        picture = read_picture(rendered / name)
        write_picture(tmp_path / "out" / NAMES[number], picture * (0.5 if number == 1 else 1))
    file = tmp_path / "checks.xml"
    limits = ("--fail-below", "psnr=30", "--fail-above", "relmse=0.01")
    assert run("compare", tmp_path / "out", rendered, *limits, "--junit", file) == 1
    said = capsys.readouterr().err.splitlines()
    assert [line.split(" is ")[1] for line in said] == ["below 30 dB", "above 0.01"]
    assert all(line.startswith("out 1, ") for line in said)
    suite = ElementTree.parse(file).getroot()
    assert (suite.get("tests"), suite.get("failures")) == ("6", "2")
    assert [case.get("classname") for case in suite.iter("testcase")] == 2 * ["out 0", "out 1", "out 2"]
    assert run("compare", tmp_path / "out" / NAMES[0], rendered / REFERENCES[0], *limits) == 0


def test_nan_misses_every_limit(frames: Path, capsys: pytest.CaptureFixture[str]) -> None:
    picture = read_picture(frames / FIRST)
    picture[0, 0] = np.nan
    write_picture(frames / "nan.exr", picture)
    for option in ("--fail-below=psnr=-inf", "--fail-above=relmse=inf", "--fail-above=flip=1"):
        assert run("compare", frames / "nan.exr", frames / FIRST, option) == 1
        said = capsys.readouterr().err.splitlines()
        assert said[0] == "nan: most measures are missing, because pixels are NaN: pictures"
        assert "was not measured" in said[1]
        assert len(said) == 2


def test_exposure_is_for_what_is_measured_as_shown(rendered: Path, capsys: pytest.CaptureFixture[str]) -> None:
    found = []
    for stops in ("0", "-3"):
        run("compare", rendered / FIRST, rendered / REFERENCES[0], f"--exposure={stops}")
        found.append(cells(capsys.readouterr().out)[0])
    usual, dark = found
    assert float(dark[1]) > float(usual[1]) + 3
    assert dark[4] == usual[4], "relMSE"


def test_json_on_the_standard_output_is_all_that_is_there(
    rendered: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run("compare", rendered, rendered, "--json", "-", "-o", tmp_path / "out") == 0
    said = capsys.readouterr()
    assert json.loads(said.out) == json.loads((tmp_path / "out" / "results.json").read_text())
    assert f"{tmp_path / 'out'}: index.html" in said.err


def test_pictures_leave_nothing_unless_a_folder_is_given(
    rendered: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert run("compare", rendered, rendered, "--json", "new/figures.json") == 0
    assert [str(path.relative_to(tmp_path)) for path in tmp_path.rglob("*.*")] == ["new/figures.json"]
    (scene,) = json.loads((tmp_path / "new/figures.json").read_text())["scenes"]
    assert (scene["frames"], list(scene["filters"])) == ([0, 1, 2], ["pictures"])


# Frames


def test_filters_are_compared_on_frames_with_references(rendered: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    command = ("compare", rendered, "--reference", rendered, "--filters", "svgf,iterations=2,accumulation", "-o", out)
    assert run(*command, "--fail-below", "psnr=1") == 0
    assert sorted(path.name for path in out.iterdir()) == [
        "figures",
        "index.html",
        "parts",
        "results.csv",
        "results.json",
    ]
    assert [path.name for path in (out / "figures").iterdir()] == [f"01.{rendered.name}.png"]
    record = json.loads((out / "results.json").read_text())
    assert "device" in record["about"]
    (scene,) = record["scenes"]
    names = ["svgf,iterations=2", "accumulation", "noisy"]
    assert list(scene["filters"]) == names
    assert "antialiased over time" in scene["note"]
    psnr = [scene["filters"][name]["values"]["psnr"] for name in names]
    assert psnr[0] > psnr[2]
    assert psnr[1] > psnr[2]
    assert scene["filters"]["noisy"]["milliseconds"] is None
    assert [row["filter"] for row in csv.DictReader((out / "results.csv").open())] == names
    page = (out / "index.html").read_text("utf-8")
    assert page.count("svgf,iterations=2") > 3
    assert page.count("data:image/") > 12


def test_frames_may_have_two_signals_and_no_colour(frames: Path, tmp_path: Path) -> None:
    pytest.importorskip("pyoidn", reason="pyoidn is not installed: pip install 'svgf-cl[oidn]'")
    for name in NAMES:
        write_frame(frames / name, replace(read_frame(frames / name), color=None))
    found = tmp_path / "found.json"
    filters = ("--filters", "svgf,oidn,oidn+accumulation")
    assert run("compare", frames, "--reference", frames, *filters, "-o", tmp_path / "out", "--json", found) == 0
    (scene,) = json.loads(found.read_text())["scenes"]
    psnr = {name: each["values"]["psnr"] for name, each in scene["filters"].items()}
    noisy = psnr.pop("noisy")
    assert all(value > noisy + 1 for value in psnr.values())


def test_a_second_run_computes_nothing_that_is_there(
    frames: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    command = ("compare", frames, "--reference", frames, "-o", tmp_path / "out", "--json", "-")
    assert run(*command, "--filters", "eaw") == 0
    first = json.loads(capsys.readouterr().out)
    begun: list[object] = []

    def broken(footage: object, *_: object) -> None:
        begun.append(footage)
        raise KeyboardInterrupt

    monkeypatch.setattr(contest, "compete", broken)
    assert run(*command, "--filters", "eaw") == 0
    assert json.loads(capsys.readouterr().out) == first
    assert not begun
    others = (("eaw,svgf",), ("eaw", "--no-jitter"), ("eaw", "--exposure=1"), ("eaw", "--reference", frames / FIRST))
    for number, (filters, *options) in enumerate(others, 1):
        assert run(*command, "--filters", filters, *options) == 130
        assert len(begun) == number


def test_a_part_that_is_damaged_is_made_anew(rendered: Path, tmp_path: Path) -> None:
    command = ("compare", rendered, "--reference", rendered, "-o", tmp_path, "--filters", "eaw")
    assert run(*command) == 0
    (part,) = (tmp_path / "parts").iterdir()
    part.write_bytes(part.read_bytes()[:1000])
    assert run(*command) == 0
    assert json.loads(part.read_text())["name"] == rendered.name


def test_only_some_frames_may_have_a_reference(frames: Path, tmp_path: Path) -> None:
    (frames / REFERENCES[1]).unlink()
    assert run("compare", frames, "--reference", frames, "--filters", "eaw", "-o", tmp_path / "out") == 0
    (scene,) = json.loads((tmp_path / "out" / "results.json").read_text())["scenes"]
    assert scene["frames"] == [0, 2]
    values = scene["filters"]["eaw"]["values"]
    assert values["psnr"] > 10
    assert values["temporal"] is None


# Wrong input


@pytest.mark.parametrize(
    ("words", "options"),
    [
        ("--fail-below: expected MEASURE=NUMBER", ["--fail-below", "sharpness=1"]),
        ("--fail-above relmse: expected a number, got nan", ["--fail-above", "relmse=nan"]),
        ("--fail-below ssim: expected a number, got ''", ["--fail-below", "ssim"]),
        ("expected stops in -64..64", ["--exposure=2000"]),
        ("expected stops in -64..64", ["--exposure=nan"]),
        ("--junit: expected --fail-below or --fail-above", ["--junit", "checks.xml"]),
        ("--filters: expected scenes, or frames with --reference", ["--filters", "svgf"]),
        ("--size: expected scenes to render", ["--size", "64x36"]),
        ("--quick: expected scenes to render", ["--quick"]),
        ("options of reading: expected frames in files, got finished pictures", ["--format", "blender"]),
    ],
)
def test_wrong_options_beside_pictures(words: str, options: list[str], rendered: Path, refused) -> None:
    refused(words, "compare", rendered, rendered, *options)


@pytest.mark.parametrize(
    ("words", "options"),
    [
        ("--filters: expected names among kalman", ["--filters", "nlm"]),
        ("--filters: expected names among kalman", ["--filters", ""]),
        ("got ''", ["--filters", "svgf,"]),
        ("--filters: expected each filter once", ["--filters", "svgf,svgf"]),
        ("no settings of oidn, got quality=fast", ["--filters", "oidn,quality=fast"]),
        ("--filters iterations: expected", ["--filters", "svgf,iterations=many"]),
        ("--spp: expected scenes to render", ["--spp", "64"]),
        ("--motion-flip: expected x, y or xy", ["--motion-flip", "z"]),
    ],
)
def test_wrong_options_beside_frames(
    words: str, options: list[str], rendered: Path, refused, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(contest, "compete", lambda *_: pytest.fail("begun"))
    pytest.importorskip("pyoidn", reason="pyoidn is not installed: pip install 'svgf-cl[oidn]'")
    refused(words, "compare", rendered, "--reference", rendered, *options)


def test_scenes_and_pictures_do_not_mix(rendered: Path, refused) -> None:
    refused("got both: swing is a scene", "compare", "swing", rendered)
    refused("got both: room.glb is a scene", "compare", rendered / FIRST, "room.glb")


def test_scenes_are_not_read(refused) -> None:
    refused("options of reading: expected frames in files, got scenes", "compare", "swing", "--still-camera")


def test_frames_alone_have_nothing_to_be_held_against(rendered: Path, refused) -> None:
    refused("expected two pictures or folders, of which the second is the reference", "compare", rendered)
    refused("got 3; to filter frames, add --reference", "compare", rendered, rendered, rendered)


def test_references_alone_are_nothing_to_filter(rendered: Path, refused) -> None:
    refused("--reference: expected frames too, got none", "compare", "--reference", rendered)


def test_empty_input(tmp_path: Path, refused) -> None:
    refused("expected files named", "compare", tmp_path, tmp_path)


def test_a_missing_file(rendered: Path, refused) -> None:
    for missing in ("nowhere.exr", "no/where"):
        refused(f"{missing}: expected a file or a folder", "compare", rendered / FIRST, missing)
        refused(f"{missing}: expected a file or a folder", "compare", missing, "--reference", rendered)
        refused(f"{missing}: expected a file or a folder", "compare", rendered, "--reference", missing)


def test_sizes_that_differ(frames: Path, refused) -> None:
    frame = read_frame(frames / NAMES[1])
    cropped = {name: np.ascontiguousarray(value[:-2]) for name, value in frame.present().items()}
    write_frame(frames / NAMES[1], replace(frame, **cropped))
    refused("0001.exr: expected 32x18 pixels", "compare", frames / NAMES[1], frames / FIRST)
    write_picture(frames / "small.exr", np.ones((10, 10, 3)))
    refused("small.exr: expected at least 11x11 pixels", "compare", frames / "small.exr", frames / "small.exr")


def test_compare_wants_like_with_like(frames: Path, refused) -> None:
    refused("two files or two folders", "compare", frames, frames / FIRST)
    (frames / "few").mkdir()
    shutil.copy(frames / FIRST, frames / "few")
    refused("expected a picture number 1", "compare", frames / "few", frames)


def test_a_reference_without_its_frame(frames: Path, refused) -> None:
    shutil.copy(frames / REFERENCES[0], frame_path(frames, 3, "reference"))
    refused("expected a frame number 3 among the frames", "compare", frames, "--reference", frames)


def test_an_output_that_cannot_be_written(rendered: Path, tmp_path: Path, refused) -> None:
    (tmp_path / "file").touch()
    for option in ("-o", "--json"):
        refused("cannot be a folder for the output", "compare", rendered, rendered, option, tmp_path / "file" / "out")


@pytest.mark.parametrize("missing", ["skimage", "jinja2"])
def test_without_a_package_it_is_said_how_to_get_it(
    missing: str, rendered: Path, refused, monkeypatch: pytest.MonkeyPatch
) -> None:
    for module in [name for name in sys.modules if name.partition(".")[0] == missing]:
        monkeypatch.setitem(sys.modules, module, None)
    monkeypatch.setitem(sys.modules, missing, None)
    refused("pip install 'svgf-cl[metrics]'", "compare", rendered, rendered)


def test_without_flip_all_else_is_measured(
    rendered: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(sys.modules, "flip_evaluator", None)
    assert run("compare", rendered, rendered) == 0
    said = capsys.readouterr()
    assert "FLIP is not measured: " in said.err
    assert "pip install 'svgf-cl[metrics]'" in said.err
    assert "FLIP" not in said.out
    assert "PSNR" in said.out
