"""``svgf-cl denoise`` as people use it."""

from __future__ import annotations

import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from svgf_cl import Frame, open_sequence
from svgf_cl.check.noise import has_noisy_depth
from svgf_cl.cli import remarks
from svgf_cl.compare.metrics import flip, psnr, ssim, why_no_flip
from svgf_cl.io.display import display
from svgf_cl.io.exr import read_image, write_channels
from svgf_cl.io.frames import read_frame, write_frame
from svgf_cl.io.pictures import read_picture
from svgf_cl.io.readers import READERS
from svgf_cl.io.reading import ReadAs, Reading, stacked
from svgf_cl.io.synthetic import room_frames
from svgf_cl.io.window import Window
from tests.command_line import NAMES, contents, run
from tests.exr_files import exr_bytes, multipart_bytes
from tests.frames import wall
from tests.renderers import (
    ARNOLD_HEADER,
    BLENDER_HEADER,
    MITSUBA_HEADER,
    NUMBERS,
    VRAY_HEADER,
    arnold,
    blender,
    cameras_file,
    mitsuba,
    moments,
    pbrt,
    truth,
    vray,
    written,
)


def test_settings_reach_the_filter(rendered: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run("denoise", rendered, "-o", tmp_path, "--set", "iterations=2") == 0
    said = capsys.readouterr().out
    assert "atrous 2" in said
    assert "atrous 3" not in said


def test_single_files_are_denoised_in_the_order_of_their_numbers(rendered: Path, tmp_path: Path) -> None:
    for number, place in enumerate((9, 10, 11)):
        shutil.copy(rendered / NAMES[number], tmp_path / f"shot.{place}.exr")
    assert run("denoise", rendered, "-o", tmp_path / "right") == 0
    assert run("denoise", *sorted(tmp_path.glob("*.exr")), "-o", tmp_path / "out") == 0
    for number, place in enumerate((9, 10, 11)):
        assert (tmp_path / "out" / f"shot.{place}.exr").read_bytes() == (
            tmp_path / "right" / NAMES[number]
        ).read_bytes()


def test_history_ends_at_a_gap(frames: Path, tmp_path: Path, refused) -> None:
    frames.joinpath(NAMES[1]).unlink()
    refused("--allow-gaps", "denoise", frames, "-o", tmp_path / "out")
    assert run("denoise", frames, "-o", tmp_path / "out", "--allow-gaps") == 0
    assert run("denoise", frames / NAMES[2], "-o", tmp_path / "alone") == 0
    assert contents(tmp_path / "alone").items() < contents(tmp_path / "out").items()


def test_a_warning_is_one_line(frames: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (frames / "frame.0003.exr.part").touch()
    assert run("denoise", frames, "-o", tmp_path) == 0
    said = capsys.readouterr().err
    assert said.startswith(f"svgf-cl: warning: {frames}: not read, but named almost like ")
    assert said.count("\n") == 1


@pytest.mark.parametrize("name", ["shot.EXR", "shot", "shot.v1.tif"])
def test_a_picture_is_called_as_its_frame(name: str, rendered: Path, tmp_path: Path) -> None:
    shutil.copy(rendered / NAMES[0], tmp_path / name)
    assert run("denoise", tmp_path / name, "-o", tmp_path / "out") == 0
    assert [path.name for path in (tmp_path / "out").iterdir()] == [f"{name.removesuffix('.EXR')}.exr"]


@pytest.mark.parametrize("stops", ["2000", "-65", "nan", "inf"])
def test_a_bad_exposure(stops: str, rendered: Path, tmp_path: Path, refused) -> None:
    refused("expected stops in -64..64", "denoise", rendered, "-o", tmp_path, "--png", f"--exposure={stops}")


def test_pictures_of_an_earlier_run_are_not_mixed_in(frames: Path, tmp_path: Path, refused) -> None:
    assert run("denoise", frames, "-o", tmp_path / "clean", "--png") == 0
    assert run("denoise", frames, "-o", tmp_path / "clean", "--png") == 0
    refused("left by an earlier run", "denoise", frames / NAMES[0], "-o", tmp_path / "clean")


def test_missing_and_empty_input(tmp_path: Path, refused) -> None:
    refused("nowhere: expected a file or a folder", "denoise", tmp_path / "nowhere", "-o", tmp_path / "out")
    refused("expected files named frame.0000.exr", "denoise", tmp_path, "-o", tmp_path / "out")


def test_sizes_that_differ(frames: Path, refused) -> None:
    frame = read_frame(frames / NAMES[1])
    cropped = {name: np.ascontiguousarray(value[:-2]) for name, value in frame.present().items()}
    write_frame(frames / NAMES[1], replace(frame, **cropped))
    refused("0001.exr: expected the display window 32x18 at 0,0", "denoise", frames, "-o", frames / "out")


def test_an_absent_field(frames: Path, refused) -> None:
    planes = read_image(frames / NAMES[0]).planes
    write_channels(frames / NAMES[0], {n: p for n, p in planes.items() if not n.startswith("normal")})
    refused("expected channels normal.X normal.Y normal.Z, found R G B", "denoise", frames, "-o", frames / "out")


def test_fields_that_change_within_a_sequence(frames: Path, refused) -> None:
    write_frame(frames / NAMES[1], replace(read_frame(frames / NAMES[1]), albedo=None))
    refused("0001.exr: expected the fields of", "denoise", frames, "-o", frames / "out")
    (frames / NAMES[1]).unlink()
    refused("0001.exr: expected this frame between", "denoise", frames, "-o", frames / "out")


def test_a_frame_of_nothing_but_nan(frames: Path, refused) -> None:
    frame = read_frame(frames / NAMES[2])
    write_frame(frames / NAMES[2], replace(frame, color=np.full_like(frame.color, np.nan)))
    refused("0002.exr: expected finite values in color", "denoise", frames, "-o", frames / "out")


def test_an_output_that_cannot_be_written(rendered: Path, tmp_path: Path, refused) -> None:
    (tmp_path / "file").touch()
    refused("cannot be a folder for the output", "denoise", rendered, "-o", tmp_path / "file" / "out")


def test_denoise_never_replaces_its_input(rendered: Path, tmp_path: Path, refused) -> None:
    refused("expected an output folder other than the input's", "denoise", rendered, "-o", rendered)
    twice = (rendered / NAMES[0], rendered / NAMES[0])
    refused("expected every file once", "denoise", *twice, "-o", tmp_path / "out")


@pytest.mark.parametrize(
    ("text", "words"),
    [("sigma=1", "a name among alpha_color,"), ("iterations=9", "in 1..5"), ("taa=maybe", "expected on or off"),
     ("sigma_depth=wide", "expected a number in"), ("iterations=2.5", "expected a whole number in 1..5")],
)  # fmt: skip
def test_a_bad_setting(text: str, words: str, rendered: Path, tmp_path: Path, refused) -> None:
    refused(words, "denoise", rendered, "-o", tmp_path, "--set", text)


def test_another_filter(rendered: Path, tmp_path: Path) -> None:
    assert run("denoise", rendered, "-o", tmp_path / "eaw", "--filter", "eaw", "--set", "sigma_color=2") == 0
    assert run("denoise", rendered, "-o", tmp_path / "svgf") == 0
    for name in NAMES:
        one, other = (read_image(tmp_path / kind / name).planes for kind in ("eaw", "svgf"))
        assert one.keys() == other.keys()
        assert any((one[channel] != other[channel]).any() for channel in one)


def test_a_filter_that_is_none(rendered: Path, tmp_path: Path, refused) -> None:
    refused("or sbf or lbf or accumulation, got 'nlm'", "denoise", rendered, "-o", tmp_path, "--filter", "nlm")
    refused("a name among", "denoise", rendered, "-o", tmp_path, "--filter", "eaw", "--set", "sigma_luminance=1")


def test_all_but_the_light_passes_through(rendered: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run("denoise", rendered, "-o", tmp_path / "out") == 0
    assert run("denoise", rendered, "-o", tmp_path / "picture", "--no-passes") == 0
    assert run("denoise", rendered, "-o", tmp_path / "plain", "--plain") == 0
    light = {*"RGB", *(f"{name}.{c}" for name in ("direct", "indirect") for c in "RGB")}
    for name in NAMES:
        noisy, clean, plain = (read_image(folder / name) for folder in (rendered, tmp_path / "out", tmp_path / "plain"))
        picture = read_image(tmp_path / "picture" / name).planes
        assert clean.planes.keys() == noisy.planes.keys() > plain.planes.keys() == {"R", "G", "B"}
        assert changed(noisy.planes, clean.planes) == light
        assert changed(noisy.planes, picture) == {"R", "G", "B"}
        assert all(plane.tobytes() == clean.planes[key].tobytes() for key, plane in plain.planes.items())
        for c in "RGB":
            np.testing.assert_allclose(
                clean.planes[f"direct.{c}"] + clean.planes[f"indirect.{c}"], clean.planes[c], rtol=1e-6, atol=1e-7
            )
    capsys.readouterr()
    assert run("denoise", rendered, "-o", tmp_path / "out", "--plain") == 0
    assert "kept" not in capsys.readouterr().out
    assert contents(tmp_path / "out") == contents(tmp_path / "plain")


def changed(before: dict[str, np.ndarray], after: dict[str, np.ndarray]) -> set[str]:
    """The channels that are not the same, bit by bit."""
    return {key for key, plane in before.items() if plane.tobytes() != after[key].tobytes()}


def test_another_attribute_or_channel_is_written_though_the_picture_is_the_same(
    frames: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run("denoise", frames, "-o", tmp_path / "out") == 0
    planes = read_image(frames / NAMES[0]).planes
    write_channels(frames / NAMES[0], planes, {"owner": "me"})
    write_channels(frames / NAMES[1], {**read_image(frames / NAMES[1]).planes, "A": np.ones_like(planes["R"])})
    capsys.readouterr()
    assert run("denoise", frames, "-o", tmp_path / "out") == 0
    assert "1 of them kept" in capsys.readouterr().out
    assert read_image(tmp_path / "out" / NAMES[0]).parts[0].attributes["owner"] == ("string", b"me")
    assert "A" in read_image(tmp_path / "out" / NAMES[1]).planes


def test_a_window_that_moves_over_a_still_picture_changes_nothing(tmp_path: Path) -> None:
    """Far from what no window had, a picture is what whole frames give; it lies where its frame did."""
    noise, display = np.random.default_rng(3).exponential(1.0, (4, 16, 40, 3)).astype(np.float32), Window(0, 0, 40, 16)
    (tmp_path / "whole").mkdir()
    (tmp_path / "moving").mkdir()
    for name, color, x in zip((*NAMES, "frame.0003.exr"), noise, (0, 3, 8, 2), strict=True):
        write_frame(tmp_path / "whole" / name, wall((16, 40), color=color))
        cut = {
            key: np.ascontiguousarray(plane[:, x:])
            for key, plane in read_image(tmp_path / "whole" / name).planes.items()
        }
        (tmp_path / "moving" / name).write_bytes(exr_bytes(cut, at=(x, 0), display=display))
    for kind in ("whole", "moving"):
        assert run("denoise", tmp_path / kind, "-o", tmp_path / f"{kind} out", "--png", "--set", "iterations=1") == 0
    whole, moving = (read_picture(tmp_path / f"{kind} out" / "frame.0003.exr") for kind in ("whole", "moving"))
    np.testing.assert_array_equal(moving[:, 16:], whole[:, 16:])
    assert not moving[:, :2].any()
    assert moving[:, 2:].all()
    windows = read_image(tmp_path / "moving out" / "frame.0003.exr").windows
    assert windows.data == Window(2, 0, 38, 16)
    assert windows.display == display
    assert run("compare", tmp_path / "moving out", tmp_path / "whole out") == 0
    assert run("check", tmp_path / "moving") in (0, 1)


# Frames of other renderers


def shots_of(folder: Path) -> dict[str, tuple[Path, list[Frame], float]]:
    """A folder of each renderer's frames; the frames that they are, and how far pictures may be apart by rounding."""
    ats = moments()
    cameras_file(folder, (0, *NUMBERS))
    vectors = [truth(at) for at in ats]
    computed = [truth(at, "id", "emission", motion=3) for at in ats]
    planes: dict[str, tuple[dict, dict, list[Frame], float]] = {
        "blender": ({at.number: blender(at, "Ebene.001 ü") for at in ats}, BLENDER_HEADER, vectors, 0.0),
        "mitsuba": ({at.number: mitsuba(at) for at in ats}, MITSUBA_HEADER, computed, 1e-2),
        "pbrt": ({at.number: pbrt(at) for at in ats}, {}, computed, 1e-2),
        "arnold": ({at.number: arnold(at, motion=True) for at in ats}, ARNOLD_HEADER, vectors, 0.0),
        "vray": ({at.number: vray(at, "max") for at in ats}, VRAY_HEADER, vectors, 1e-4),
    }
    return {
        name: (written(folder / name, channels, header, "frame."), frames, tolerance)
        for name, (channels, header, frames, tolerance) in planes.items()
    }


@pytest.mark.parametrize("renderer", ["blender", "mitsuba", "pbrt", "arnold", "vray"])
def test_frames_of_a_renderer_are_denoised_as_if_they_were_our_own(
    renderer: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder, frames, tolerance = shots_of(tmp_path)[renderer]
    for number, frame in zip(NUMBERS, frames, strict=True):
        write_frame(tmp_path / "own" / f"frame.{number:04d}.exr", frame)
    alone = ("--no-passes", "--prefilter", "off")
    assert run("denoise", tmp_path / "own", "-o", tmp_path / "expected", *alone) == 0
    capsys.readouterr()
    assert run("denoise", folder, "-o", tmp_path / "out", "--plain", *alone) == 0
    assert f"read as frames of {READERS[renderer].title}" in capsys.readouterr().out
    for number in NUMBERS:
        found, expected = (
            read_image(tmp_path / kind / f"frame.{number:04d}.exr").planes for kind in ("out", "expected")
        )
        for c in "RGB":
            np.testing.assert_allclose(found[c], expected[c], rtol=tolerance, atol=tolerance)


@pytest.mark.parametrize("renderer", ["blender", "arnold", "vray"])
def test_light_passes_of_a_renderer_still_add_up_and_all_else_passes_through(renderer: str, tmp_path: Path) -> None:
    folder, *_ = shots_of(tmp_path)[renderer]
    assert run("denoise", folder, "-o", tmp_path / "out") == 0
    for path in sorted(folder.iterdir()):
        before, after = read_image(path), read_image(tmp_path / "out" / path.name)
        assert before.parts[0].attributes == after.parts[0].attributes
        reading = Reading(path, before, ReadAs())
        lights, picture = reading.lights, reading.picture
        total = added_up(path, after.planes, reading)
        np.testing.assert_allclose(total, stacked(path, after.planes, picture), rtol=1e-5, atol=1e-6)
        denoised = {*picture, *(name for light in lights if light.filtered for name in light.channels)}
        assert len(denoised) == 9
        assert changed(before.planes, after.planes) == denoised


def test_what_is_denoised_is_added_as_a_layer(tmp_path: Path) -> None:
    folder, *_ = shots_of(tmp_path)["blender"]
    assert run("denoise", folder, "-o", tmp_path / "out") == 0
    assert run("denoise", folder, "-o", tmp_path / "layer", "--layer", "Denoised") == 0
    for path in sorted(folder.iterdir()):
        noisy, clean, both = (read_image(p / path.name).planes for p in (folder, tmp_path / "out", tmp_path / "layer"))
        assert not changed(noisy, both)
        added = both.keys() - noisy.keys()
        assert added == {f"Denoised.{name}.{c}" for name in ("Combined", "DiffDir", "DiffInd") for c in "RGB"}
        for name in added:
            np.testing.assert_array_equal(both[name], clean[f"Ebene.001 ü.{name.removeprefix('Denoised.')}"])


def test_one_view_layer_of_two_is_denoised(tmp_path: Path, refused) -> None:
    planes = {at.number: {**blender(at, "Set"), **blender(at, "Fog")} for at in moments()}
    folder = written(tmp_path / "shot", planes, BLENDER_HEADER)
    refused(
        "expected one view layer, found Fog, Set; choose with --view-layer", "denoise", folder, "-o", tmp_path / "a"
    )
    refused("expected a view layer 'Sky', found Fog, Set", "denoise", folder, "-o", tmp_path, "--view-layer", "Sky")
    assert run("denoise", folder, "-o", tmp_path / "out", "--view-layer", "Set") == 0
    before, after = (read_image(p / "shot_0002.exr").planes for p in (folder, tmp_path / "out"))
    assert {name.split(".")[0] for name in changed(before, after)} == {"Set"}


def test_parts_of_a_file_stay_parts(tmp_path: Path) -> None:
    (tmp_path / "shot").mkdir()
    for at in moments():
        parts: dict[str, dict[str, np.ndarray]] = {}
        for channel, plane in blender(at).items():
            parts.setdefault(channel.rpartition(".")[0], {})[channel] = plane
        (tmp_path / "shot" / f"{at.number:04d}.exr").write_bytes(multipart_bytes(parts, BLENDER_HEADER))
    assert run("denoise", tmp_path / "shot", "-o", tmp_path / "out") == 0
    before, after = (read_image(tmp_path / kind / "0002.exr") for kind in ("shot", "out"))
    assert [part.planes.keys() for part in before.parts] == [part.planes.keys() for part in after.parts]
    assert [part.attributes for part in before.parts] == [part.attributes for part in after.parts]
    assert len(changed(before.planes, after.planes)) == 9


def test_a_mistaken_format_is_told(tmp_path: Path, refused) -> None:
    folder, *_ = shots_of(tmp_path)["arnold"]
    refused("--format: expected svgf_cl or blender", "denoise", folder, "-o", tmp_path / "out", "--format", "maya")
    refused("in a file of Blender (Cycles)", "denoise", folder, "-o", tmp_path / "out", "--format", "blender")


def test_a_pass_that_a_frame_in_the_middle_lacks_ends_the_run_there(tmp_path: Path, refused) -> None:
    planes = {at.number: blender(at) for at in moments()}
    planes[2] = {name: plane for name, plane in planes[2].items() if ".DiffInd." not in name}
    folder = written(tmp_path / "shot", planes, BLENDER_HEADER)
    refused("shot_0002.exr: expected the light pass ViewLayer.DiffInd.R", "denoise", folder, "-o", tmp_path / "out")
    assert [path.name for path in (tmp_path / "out").iterdir()] == ["shot_0001.exr"]


# Some of the frames


def test_a_stretch_with_the_past_of_all_frames_before_is_as_of_the_whole_shot(frames: Path, tmp_path: Path) -> None:
    assert run("denoise", frames, "-o", tmp_path / "whole") == 0
    for warm_up, same in ((2, True), (1000, True), (0, False)):
        out = tmp_path / f"out{warm_up}"
        assert run("denoise", frames, "-o", out, "--frames", "2", "--warm-up", str(warm_up)) == 0
        assert [path.name for path in out.iterdir()] == [NAMES[2]]
        assert ((out / NAMES[2]).read_bytes() == (tmp_path / "whole" / NAMES[2]).read_bytes()) == same


def test_stretches_of_several_machines_meet_in_one_folder(frames: Path, tmp_path: Path) -> None:
    assert run("denoise", frames, "-o", tmp_path / "whole") == 0
    for span in ("0-1", "2-2"):
        assert run("denoise", frames, "-o", tmp_path / "out", "--frames", span, "--warm-up", "2") == 0
    assert contents(tmp_path / "out") == contents(tmp_path / "whole")


@pytest.mark.parametrize(
    ("span", "words"),
    [
        ("5-9", "--frames: expected frames among 0-2, got 5-9"),
        ("2-1", "--frames: expected FIRST-LAST"),
        ("one", "--frames: expected FIRST-LAST"),
    ],
)
def test_frames_that_are_not_there(span: str, words: str, frames: Path, tmp_path: Path, refused) -> None:
    refused(words, "denoise", frames, "-o", tmp_path / "out", "--frames", span)
    assert not (tmp_path / "out").exists()


def test_negative_numbers(rendered: Path, tmp_path: Path) -> None:
    (tmp_path / "shot").mkdir()
    for number, name in zip((-2, -1, 0), NAMES, strict=True):
        shutil.copy(rendered / name, tmp_path / "shot" / (f"a.-{-number:04d}.exr" if number else "a.0000.exr"))
    assert run("denoise", tmp_path / "shot" / "a.####.exr", "-o", tmp_path / "out" / "b.%03d.exr") == 0
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == ["b.-001.exr", "b.-002.exr", "b.000.exr"]
    assert run("denoise", tmp_path / "shot", "-o", tmp_path / "two", "--frames", "-2--1") == 0
    assert sorted(path.name for path in (tmp_path / "two").iterdir()) == ["a.-0001.exr", "a.-0002.exr"]


# Where pictures go


@pytest.mark.parametrize("pattern", ["b.####.exr", "b.%04d.exr"])
def test_pictures_are_named_by_a_pattern(pattern: str, frames: Path, tmp_path: Path) -> None:
    assert run("denoise", frames / "frame.####.exr", "-o", tmp_path / "out" / pattern) == 0
    assert sorted(p.name for p in (tmp_path / "out").iterdir()) == [f"b.{number:04d}.exr" for number in range(3)]


@pytest.mark.parametrize("pattern", ["frame.####.exr", "frame.%04d.exr"])
def test_a_pattern_never_replaces_the_input(pattern: str, frames: Path, refused) -> None:
    before = contents(frames)
    refused("frame.0000.exr: expected an output folder other than", "denoise", frames, "-o", frames / pattern)
    assert contents(frames) == before


def test_a_pattern_of_two_numbers_is_refused(frames: Path, tmp_path: Path, refused) -> None:
    refused("expected one number, as #### or %04d, got 2", "denoise", frames, "-o", tmp_path / "out" / "##.##.exr")


def test_an_input_pattern_that_fits_nothing(frames: Path, tmp_path: Path, refused) -> None:
    for pattern in ("x.####.exr", "x.%d.exr", "x.*.exr"):
        refused(f"{pattern}: expected files of this pattern, found none", "denoise", frames / pattern, "-o", tmp_path)


def test_a_layer_of_nothing_else_is_refused(frames: Path, tmp_path: Path, refused) -> None:
    refused("--layer: expected no --plain", "denoise", frames, "-o", tmp_path / "out", "--layer", "a", "--plain")


# What renderers wrote

SAMPLES = Path(__file__).parents[4] / "shared" / "samples"


@pytest.fixture(scope="module")
def sample(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """A folder of frames as a renderer wrote them, and what comes of it without any option."""
    folder = SAMPLES / request.param
    if not folder.exists():
        pytest.skip(f"{folder} is not here")
    out = tmp_path_factory.mktemp("sample") / "out"
    assert run("denoise", folder, "-o", out) == 0
    return folder, out


@pytest.mark.parametrize("sample", ["blender/noisy", "mitsuba/noisy"], indirect=True)
def test_every_frame_of_a_sample_is_better_by_all_measures(sample: tuple[Path, Path]) -> None:
    folder, out = sample
    first, *between, last = sorted(folder.iterdir())
    for path in (first, *between, last):
        reference = folder.parent / "reference" / path.name
        wanted, noisy, clean = (display(read_picture(file)) for file in (reference, path, out / path.name))
        assert psnr(clean, wanted) > psnr(noisy, wanted) + 3
        assert ssim(clean, wanted) > ssim(noisy, wanted) + 0.1
        if path not in between and not why_no_flip():  # FLIP takes as long as all else
            assert flip(clean, wanted) < flip(noisy, wanted)


@pytest.mark.parametrize("sample", ["blender/noisy", "mitsuba/noisy", "blender/noisy_dof_4spp"], indirect=True)
def test_all_but_the_light_of_a_sample_is_as_it_was_and_the_light_adds_up(sample: tuple[Path, Path]) -> None:
    folder, out = sample
    shot = open_sequence(folder)
    reading, is_noisy = shot.reading, has_noisy_depth(shot[0])
    for path in shot.paths:
        before, after = read_image(path), read_image(out / path.name)
        made = {*reading.picture, *(name for light in reading.lights if light.filtered for name in light.channels)}
        if is_noisy:  # then all that light is made of is filtered
            made |= {name for light in reading.lights for name in (*light.channels, *light.factor)}
        assert before.windows == after.windows
        assert [part.attributes for part in before.parts] == [part.attributes for part in after.parts]
        assert before.planes.keys() == after.planes.keys()
        assert changed(before.planes, after.planes) <= made
        noisy, clean = (added_up(path, image.planes, reading) for image in (before, after))
        if reading.lights:
            # What the passes are not, in the picture, is what they were not in the noisy one, but for rounding to half.
            rest = stacked(path, before.planes, reading.picture) - noisy
            size = np.abs(noisy) + np.abs(clean)
            left = np.abs(rest) > 2.0**-9 * size + 1e-6
            off = np.abs(stacked(path, after.planes, reading.picture) - clean)
            assert left.mean() < 0.05
            assert (off[~left] <= 1e-5 * (1 + size[~left])).mean() > 0.95


def added_up(path: Path, planes: dict[str, np.ndarray], reading: Reading) -> np.ndarray:
    total = np.zeros((*next(iter(planes.values())).shape, 3), np.float32)
    for light in reading.lights:
        factor = stacked(path, planes, light.factor) if light.factor else np.float32(1)
        total += stacked(path, planes, light.channels) * factor
    return total


def test_the_first_frames_of_a_shot_in_chunks_are_checked_once_and_in_order(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Warm-ups go over the same frames again, which no motion leads to."""
    frames = list(room_frames((18, 32), 10))
    (tmp_path / "shot").mkdir()
    for number, frame in enumerate(frames):
        write_frame(tmp_path / "shot" / f"frame.{number:04d}.exr", frame)
    checked = []
    monkeypatch.setattr(remarks.Inspection, "add", lambda self, frame: checked.append(frame.color))
    for chunk in (("--chunk", "2", "--warm-up", "2"), ()):
        checked.clear()
        assert run("denoise", tmp_path / "shot", "-o", tmp_path / "out", *chunk) == 0
        assert len(checked) == remarks.FIRST
        np.testing.assert_array_equal(checked, [frame.color for frame in frames[: remarks.FIRST]])


@pytest.mark.parametrize(("name", "words"), [("Ebene", "no layer 'Ebene' yet"), ("", "a name"), ("a.b", "a name")])
def test_a_layer_must_be_a_new_one_and_a_name(name: str, words: str, tmp_path: Path, refused) -> None:
    planes = {at.number: blender(at, "Ebene") for at in moments()}
    folder = written(tmp_path / "shot", planes, BLENDER_HEADER)
    refused(f"expected {words}", "denoise", folder, "-o", tmp_path / "out", "--layer", name)


def test_later_frames_make_pictures_steadier(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    noise, folder = np.random.default_rng(5).exponential(1.0, (6, 24, 40, 3)).astype(np.float32), tmp_path / "shot"
    folder.mkdir()
    for number, color in enumerate(noise):
        write_frame(folder / f"frame.{number:04d}.exr", wall((24, 40), color=color))
    spread = {}
    for name, options in {"forward": (), "two": ("--look-ahead", "2"), "all": ("--look-ahead", "all")}.items():
        assert run("denoise", folder, "-o", tmp_path / name, *options) == 0
        pictures = [read_picture(tmp_path / name / f"frame.{number:04d}.exr") for number in range(6)]
        spread[name] = float(np.diff(pictures, axis=0).std())
    assert spread["all"] < spread["two"] < spread["forward"]


@pytest.mark.parametrize("frames", ["0", "-1", "many", "1.5"])
def test_a_bad_number_of_later_frames(frames: str, rendered: Path, tmp_path: Path, refused) -> None:
    refused("--look-ahead: expected a number of frames, or all", "denoise", rendered, "-o", tmp_path,
            f"--look-ahead={frames}")  # fmt: skip


def test_frames_or_color(rendered: Path, tmp_path: Path, refused) -> None:
    refused("expected either FRAMES or --color, got neither", "denoise", "-o", tmp_path / "out")
    refused("expected either FRAMES or --color, got both", "denoise", rendered, "--color", rendered, "-o", tmp_path)
    assert run("denoise", "--color", rendered, "-o", tmp_path / "out") == 0
    assert len(list((tmp_path / "out").iterdir())) == len(NAMES)


def test_a_bad_prefilter(rendered: Path, tmp_path: Path, refused) -> None:
    refused("--prefilter: expected auto or on or off", "denoise", rendered, "-o", tmp_path, "--prefilter", "maybe")
