"""Frames of Blender: every view layer's name, files of several parts, and all that a frame of it may lack."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from svgf_cl import FileError, open_sequence
from svgf_cl.io.exr import read_image
from svgf_cl.io.readers import reader_of
from tests.exr_files import exr_bytes, multipart_bytes
from tests.renderers import (
    BLENDER_HEADER,
    NUMBERS,
    Header,
    Planes,
    blender,
    layer,
    moments,
    rgb,
    same_frames,
    truth,
    written,
)

NAMES = ["ViewLayer", "Main Layer", "Ebene.001 ü", "Rendu", "视图层", "A"]


def shot(folder: Path, view_layer: str = "ViewLayer", without: str = " ") -> Path:
    planes = {at.number: blender(at, view_layer) for at in moments()}
    return written(folder, {n: lacking(each, without) for n, each in planes.items()}, BLENDER_HEADER)


def lacking(planes: Planes, name: str) -> Planes:
    return {channel: plane for channel, plane in planes.items() if f".{name}." not in channel}


def alone(planes: Planes, name: str) -> Planes:
    """The channels of a pass, by their components."""
    return {channel[-1]: plane for channel, plane in planes.items() if channel.split(".")[1] == name}


@pytest.mark.parametrize("view_layer", NAMES)
def test_frames_are_read_whatever_the_view_layer_is_called(view_layer: str, tmp_path: Path) -> None:
    frames = open_sequence(shot(tmp_path, view_layer))
    assert frames.reading.reader.name == "blender"
    assert frames.reading.view_layer == view_layer
    same_frames(frames, [truth(at) for at in moments()])
    for index, at in enumerate(moments()):
        np.testing.assert_array_equal(frames.motion_to_next(frames.read(index)), at.to_next)


def test_blender_is_known_without_its_attribute_too(tmp_path: Path) -> None:
    """Other programs drop the attributes that they do not know."""
    folder = written(tmp_path, {at.number: blender(at) for at in moments()})
    assert open_sequence(folder).reading.reader.name == "blender"


def test_a_file_may_have_a_part_for_each_pass(tmp_path: Path) -> None:
    """Blender repeats the name of a part in those of its channels."""
    for at in moments():
        parts: dict[str, Planes] = {}
        for channel, plane in blender(at, "Ebene.001").items():
            parts.setdefault(channel.rpartition(".")[0], {})[channel] = plane
        (tmp_path / f"{at.number}.exr").write_bytes(multipart_bytes(parts, BLENDER_HEADER))
    frames = open_sequence(tmp_path)
    same_frames(frames, [truth(at) for at in moments()])
    assert [light.filtered for light in frames.reading.lights] == [True, True, False, False]


# What Blender writes into the header of every file, where it is not told to leave it out.
STAMP: Header = dict.fromkeys(("Camera", "Date", "File", "Frame", "RenderTime", "Scene", "Time"), ("string", b"x"))


def test_each_pass_may_have_a_file_of_its_own(tmp_path: Path) -> None:
    """The compositor's File Output node in format OpenEXR names no layer, and calls a plain value V."""
    names = ("Normal", "Depth", "Vector", "IndexOB", "Denoising Albedo")
    passes = {name: {at.number: alone(blender(at), name) for at in moments()} for name in names}
    for number in NUMBERS:
        passes["Depth"][number] = {"V": passes["Depth"][number]["Z"]}
        passes["IndexOB"][number] = {"V": passes["IndexOB"][number]["X"]}
        del passes["Vector"][number]["W"]
    for name, planes in passes.items():
        written(tmp_path, planes, STAMP, f"{name}_")
    written(tmp_path, {at.number: rgb(at.frame.color) for at in moments()}, STAMP, "Image_")
    fields = zip(("normal", "depth", "motion", "id", "albedo"), passes, strict=True)
    separate = {field: tmp_path / f"{name}_####.exr" for field, name in fields}
    frames = open_sequence(tmp_path / "Image_####.exr", separate=separate)
    assert frames.reading.reader.name == "blender"
    same_frames(frames, [truth(at, "emission") for at in moments()])


def test_a_picture_alone_says_that_there_is_a_format_for_more(tmp_path: Path) -> None:
    frames = open_sequence(written(tmp_path, {at.number: rgb(at.frame.color) for at in moments()}, STAMP))
    with pytest.raises(FileError, match=r"expected normal, depth, motion in.*write OpenEXR MultiLayer:.*Data > Z"):
        frames[0]


def test_one_of_several_view_layers_is_read(tmp_path: Path) -> None:
    at = moments()[0]
    other = {name: plane + 1 for name, plane in blender(at, "Fog").items()}
    (tmp_path / "1.exr").write_bytes(exr_bytes({**other, **blender(at, "Set")}, BLENDER_HEADER))
    with pytest.raises(FileError, match=r"1\.exr: expected one view layer, found Fog, Set; choose with --view-layer"):
        open_sequence(tmp_path)
    with pytest.raises(FileError, match=r"1\.exr: expected a view layer 'Cars', found Fog, Set"):
        open_sequence(tmp_path, view_layer="Cars")
    same_frames(open_sequence(tmp_path, view_layer="Set"), [truth(at)])


def test_the_composited_picture_beside_a_view_layer_is_no_view_layer(tmp_path: Path) -> None:
    """With compositing nodes Blender adds Composite.Combined, which has no other pass."""
    at = moments()[0]
    composite = layer("Composite.Combined", np.zeros((*at.frame.shape, 4), np.float32), "RGBA")
    (tmp_path / "1.exr").write_bytes(exr_bytes({**composite, **blender(at)}, BLENDER_HEADER))
    same_frames(open_sequence(tmp_path), [truth(at)])


def test_passes_are_read_in_the_names_of_blender_5(tmp_path: Path) -> None:
    names = {
        "IndexOB": "Object Index", "DiffDir": "Diffuse Direct", "DiffInd": "Diffuse Indirect",
        "DiffCol": "Diffuse Color", "Emit": "Emission", "Env": "Environment",
    }  # fmt: skip
    planes = {
        at.number: {
            f"ViewLayer.{names.get(c.split('.')[1], c.split('.')[1])}.{c[-1]}": p for c, p in blender(at).items()
        }
        for at in moments()
    }
    frames = open_sequence(written(tmp_path, planes))
    same_frames(frames, [truth(at) for at in moments()])
    assert len(frames.reading.lights) == 4


def test_cryptomatte_tells_objects_apart_better_than_an_index(tmp_path: Path) -> None:
    at = moments()[0]
    numbers = at.frame.id * np.uint32(0x9E3779B1)
    crypto = np.stack([numbers.view(np.float32), *np.zeros((3, *at.frame.shape), np.float32)], axis=-1)
    planes = {**blender(at), **layer("ViewLayer.CryptoObject00", crypto, "rgba")}
    (frame,) = open_sequence(written(tmp_path, {1: planes}))
    np.testing.assert_array_equal(frame.id, numbers, strict=True)


def test_an_index_at_an_edge_is_that_of_a_neighbour(tmp_path: Path) -> None:
    at = moments()[0]
    planes = blender(at)
    planes["ViewLayer.IndexOB.X"] = np.where(np.arange(at.frame.shape[1]) < 10, 3, 7).astype(np.float32) + np.zeros(
        at.frame.shape, np.float32
    )
    planes["ViewLayer.IndexOB.X"][:, 10] = 5.25
    (frame,) = open_sequence(written(tmp_path, {1: planes}))
    assert set(np.unique(frame.id)) == {3, 7}


@pytest.mark.parametrize(
    ("lost", "words"),
    [
        ("Normal", "expected normal in a file of Blender.*Passes > Data > Normal"),
        ("Depth", "expected depth in a file of Blender.*Passes > Data > Z$"),
        (
            "Vector",
            "expected motion in a file of Blender.*Passes > Data > Vector, and turn off .*Motion Blur.*cameras.json",
        ),
        ("Combined", "expected color in a file of Blender.*OpenEXR MultiLayer"),
    ],
)
def test_a_missing_pass_is_named_with_the_switch_that_writes_it(lost: str, words: str, tmp_path: Path) -> None:
    frames = open_sequence(shot(tmp_path, "Main Layer", lost))
    with pytest.raises(FileError, match=rf"shot_0001\.exr: {words}") as error:
        frames[0]
    assert "found Main Layer." in str(error.value)
    assert ("--still-camera" in str(error.value)) == (lost == "Vector")


def test_what_is_not_required_may_be_missing(tmp_path: Path) -> None:
    for lost, field in (("Denoising Albedo", "albedo"), ("IndexOB", "id")):
        same_frames(open_sequence(shot(tmp_path / field, without=lost)), [truth(at, field) for at in moments()])


def test_a_pass_of_light_without_its_colour_is_not_one(tmp_path: Path) -> None:
    assert open_sequence(shot(tmp_path, without="DiffCol")).reading.lights == ()


@pytest.mark.parametrize("lost", ["Normal", "DiffDir", "DiffCol", "Emit", "Denoising Albedo", "IndexOB"])
def test_a_pass_that_a_later_frame_lacks_is_named(lost: str, tmp_path: Path) -> None:
    planes = {at.number: blender(at) for at in moments()}
    planes[2] = lacking(planes[2], lost)
    frames = open_sequence(written(tmp_path, planes))
    words = {"Normal": "normal", "Denoising Albedo": "without albedo", "IndexOB": "without id"}.get(lost, lost)
    assert frames[0].shape == frames.shape
    with pytest.raises(FileError, match=rf"shot_0002\.exr: expected .*{words}"):
        frames[1]


def test_half_floats_are_read(tmp_path: Path) -> None:
    """As Blender writes colour; in half floats the scene is what these are."""
    planes = {
        at.number: {c: p.astype(np.float16) if c[-1] in "RGBA" else p for c, p in blender(at).items()}
        for at in moments()
    }
    for frame, at in zip(open_sequence(written(tmp_path, planes)), moments(), strict=True):
        np.testing.assert_array_equal(frame.color, at.frame.color.astype(np.float16).astype(np.float32), strict=True)
        np.testing.assert_array_equal(frame.motion, at.frame.motion[..., :2], strict=True)


SAMPLE = Path(__file__).parents[5] / "shared" / "samples" / "blender" / "noisy"


@pytest.mark.skipif(not SAMPLE.exists(), reason=f"{SAMPLE} is not here")
def test_a_frame_of_blender_is_read() -> None:
    assert reader_of(read_image(SAMPLE / "shot_0001.exr")).name == "blender"
    frames = open_sequence(SAMPLE)
    assert (len(frames), frames.shape, frames.reading.view_layer) == (8, (144, 256), "Main Layer")
    frame = frames[3]
    assert set(frame.present()) == {"color", "albedo", "normal", "depth", "motion", "id", "emission"}
    assert np.isinf(frame.depth[frame.id == 0]).all()
